/* One picture out of its transfers: whether it is whole, what was said of it, and a frame of it. */
#include "drivers/u3v/picture.h"

#include "base/memory.h"

#include <string.h>

const char *placido_u3v_trouble(enum placido_u3v_end end) {
  static const char *const sentences[] = {
      [PLACIDO_U3V_DONE] = "no error",
      [PLACIDO_U3V_TIMED_OUT] = "a transfer timed out",
      [PLACIDO_U3V_STALLED] = "the camera halted its stream",
      [PLACIDO_U3V_OVERFLOW] = "the camera sent more than was agreed",
      [PLACIDO_U3V_CANCELLED] = "the system cancelled a transfer",
      [PLACIDO_U3V_GONE] = "the camera was unplugged",
      [PLACIDO_U3V_FAILED] = "a transfer failed on the bus, or there is no memory for USB left "
                             "(usbfs_memory_mb)",
  };
  return (size_t)end < sizeof sentences / sizeof *sentences ? sentences[end] : "unknown error";
}

static enum placido_u3v_verdict lose(placido_u3v_picture *picture, const char *trouble) {
  picture->trouble = trouble;
  return PLACIDO_U3V_LOST;
}

/* Whether a short transfer among those for samples is the end of this picture. */
static bool is_trailer(placido_u3v_picture *picture, const placido_u3v_transfer *transfer) {
  placido_u3v_trailer trailer;
  if (placido_u3v_trailer_decode(&trailer, transfer->bytes, transfer->received, NULL) ||
      trailer.frame_id != picture->leader.frame_id || trailer.payload_bytes > picture->bytes) {
    return false;
  }
  picture->trailer = trailer;
  picture->trouble = "a picture ended early";
  return true;
}

/* A transfer of samples, `index` among all. True where it is the trailer. */
static bool add_samples(placido_u3v_picture *picture, const placido_u3v_ring *ring, size_t index,
                        bool *has_hole) {
  const placido_u3v_transfer *transfer =
      &ring->slots[ring->taken % ring->slot_count].transfers[index];
  const size_t begin = (index - 1) * ring->layout.transfer_bytes;
  const size_t left = ring->layout.required_bytes - begin;
  const size_t expected = transfer->size < left ? transfer->size : left;
  const bool is_short = transfer->received < expected;
  if (is_short && is_trailer(picture, transfer)) {
    return true;
  }
  if (!*has_hole) {
    picture->bytes += is_short ? transfer->received : expected;
  }
  *has_hole = *has_hole || is_short;
  return false;
}

enum placido_u3v_verdict placido_u3v_picture_look(placido_u3v_picture *picture,
                                                  const placido_u3v_ring *ring) {
  const placido_u3v_slot *slot = &ring->slots[ring->taken % ring->slot_count];
  bool has_hole = false;
  *picture = (placido_u3v_picture){0};
  for (size_t i = 0; i < ring->slot_transfers; i++) {
    const placido_u3v_transfer *transfer = &slot->transfers[i];
    if (placido_u3v_ring_is_pending(ring, i)) {
      return PLACIDO_U3V_PENDING;
    }
    if (transfer->end != PLACIDO_U3V_DONE) {
      picture->is_gone = transfer->end == PLACIDO_U3V_GONE;
      return lose(picture, placido_u3v_trouble(transfer->end));
    }
    if (i == 0) {
      if (placido_u3v_leader_decode(&picture->leader, slot->leader, transfer->received, NULL)) {
        return lose(picture, "a picture came without its beginning");
      }
    } else if (i + 1 == ring->slot_transfers) {
      if (placido_u3v_trailer_decode(&picture->trailer, slot->trailer, transfer->received,
                                     NULL)) {
        return lose(picture, "a picture came without its end");
      }
    } else if (add_samples(picture, ring, i, &has_hole)) {
      return PLACIDO_U3V_EARLY;
    }
  }
  return PLACIDO_U3V_WHOLE;
}

uint64_t placido_u3v_picture_lost(const placido_u3v_ring *ring, uint64_t last_id) {
  const size_t count = ring->slot_count * ring->slot_transfers;
  uint64_t lost = 0;
  for (uint64_t i = ring->taken * ring->slot_transfers; i < ring->submitted; i++) {
    const placido_u3v_transfer *transfer = &ring->transfers[i % count];
    placido_u3v_leader leader;
    if (transfer->is_pending || transfer->received == 0) {
      continue;
    }
    lost = lost > 0 ? lost : 1;
    if (transfer->received < transfer->size &&
        placido_u3v_leader_decode(&leader, transfer->bytes, transfer->received, NULL) == 0 &&
        leader.frame_id - last_id > lost && leader.frame_id - last_id < count) {
      lost = leader.frame_id - last_id;
    }
  }
  return lost;
}

/* The picture's rows in its block. */
struct rows {
  size_t row_bytes, distance_bytes;
  int width_px, height_px, whole_count;
};

/* Refuses what is not within the agreed. */
static int find_rows(struct rows *rows, const placido_u3v_picture *picture,
                     const placido_u3v_ring *ring, const placido_u3v_mode *mode,
                     placido_error *err) {
  const placido_u3v_leader *leader = &picture->leader;
  *rows = (struct rows){0};
  if (leader->payload_type != PLACIDO_U3V_PAYLOAD_IMAGE &&
      leader->payload_type != PLACIDO_U3V_PAYLOAD_IMAGE_CHUNKS) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera sent data of type 0x%04x, which is no picture",
                             (unsigned)leader->payload_type);
  }
  if (leader->pixel_format != mode->format->code || leader->width_px < 1 ||
      leader->height_px < 1 || leader->width_px > (uint32_t)mode->width_px ||
      leader->height_px > (uint32_t)mode->height_px) {
    return placido_error_set(
        err, PLACIDO_INPUT,
        "the camera sent a picture of %u x %u pixels, format 0x%08x; agreed was %d x %d, %s",
        (unsigned)leader->width_px, (unsigned)leader->height_px, (unsigned)leader->pixel_format,
        mode->width_px, mode->height_px, mode->format->name);
  }
  rows->width_px = (int)leader->width_px;
  rows->height_px = (int)leader->height_px;
  rows->row_bytes = placido_pixel_row_bytes(mode->format, rows->width_px);
  rows->distance_bytes = rows->row_bytes + leader->padding_x_bytes;
  if (rows->distance_bytes * (size_t)(rows->height_px - 1) + rows->row_bytes >
      ring->layout.required_bytes) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera sent rows of %zu bytes, more than was agreed",
                             rows->distance_bytes);
  }
  return PLACIDO_OK;
}

/* Rows that came wholly: as the bytes say, and the trailer. */
static void count_rows(struct rows *rows, const placido_u3v_picture *picture) {
  const size_t said = picture->trailer.payload_bytes < picture->bytes
                          ? (size_t)picture->trailer.payload_bytes
                          : picture->bytes;
  size_t count =
      said < rows->row_bytes ? 0 : (said - rows->row_bytes) / rows->distance_bytes + 1;
  if (picture->trailer.height_px > 0 && picture->trailer.height_px < count) {
    count = picture->trailer.height_px;
  }
  rows->whole_count = count < (size_t)rows->height_px ? (int)count : rows->height_px;
}

/* Gives the slot's block to the frame, and the slot another: the frame's where it is large enough.
 * On failure nothing has changed. */
static int swap_blocks(placido_frame *frame, placido_u3v_slot *slot, size_t block_bytes,
                       placido_error *err) {
  uint8_t *spare = frame->data;
  size_t spare_bytes = frame->capacity;
  if (spare_bytes < block_bytes) {
    spare = placido_memory_new_aligned(block_bytes, err);
    if (!spare) {
      return PLACIDO_MEMORY;
    }
    spare_bytes = block_bytes;
    if (frame->capacity > 0) {
      placido_memory_free(frame->data);
    }
  }
  frame->data = slot->block;
  frame->capacity = slot->block_bytes;
  slot->block = spare;
  slot->block_bytes = spare_bytes;
  return PLACIDO_OK;
}

/* The samples as they came. */
static int lend(placido_frame *frame, placido_u3v_slot *slot, size_t block_bytes,
                const struct rows *rows, const placido_u3v_mode *mode, placido_error *err) {
  const int status = swap_blocks(frame, slot, block_bytes, err);
  if (status) {
    return status;
  }
  frame->width_px = rows->width_px;
  frame->height_px = rows->height_px;
  frame->stride_bytes = rows->distance_bytes;
  frame->format = mode->format->bits > 8 ? PLACIDO_MONO16 : PLACIDO_MONO8;
  frame->bits = mode->format->bits;
  return PLACIDO_OK;
}

int placido_u3v_picture_to_frame(placido_frame *frame, const placido_u3v_picture *picture,
                                 placido_u3v_ring *ring, const placido_u3v_mode *mode,
                                 placido_error *err) {
  placido_u3v_slot *slot = placido_u3v_ring_head(ring);
  const size_t block_bytes = placido_u3v_layout_block_bytes(&ring->layout);
  struct rows rows;
  int status = find_rows(&rows, picture, ring, mode, err);
  if (status) {
    return status;
  }
  count_rows(&rows, picture);
  const size_t whole_bytes = rows.distance_bytes * (size_t)rows.whole_count;
  if (rows.whole_count < rows.height_px) { /* the block still has an older picture there */
    memset(slot->block + whole_bytes, 0, block_bytes - whole_bytes);
  }
  const bool fits = rows.distance_bytes * (size_t)rows.height_px <= block_bytes &&
                    (mode->format->bits <= 8 || rows.distance_bytes % 2 == 0);
  status = placido_pixel_is_plain(mode->format) && fits
               ? lend(frame, slot, block_bytes, &rows, mode, err)
               : placido_pixel_to_frame(frame, mode->format, slot->block, block_bytes,
                                        rows.width_px, rows.height_px, rows.distance_bytes, err);
  if (status) {
    return status;
  }
  const bool is_corrupt = picture->trailer.status != 0 ||
                          picture->trailer.frame_id != picture->leader.frame_id;
  frame->flags = (is_corrupt ? PLACIDO_FRAME_CORRUPT : 0) |
                 (rows.whole_count < rows.height_px ? PLACIDO_FRAME_TRUNCATED : 0);
  return PLACIDO_OK;
}
