/* How a picture comes in transfers, after USB3 Vision 1.0, section 5: sizes are multiples of the
 * alignment that the camera asks for. Here they are multiples of 1,024 too, the largest packet: a
 * transfer that ends within a packet would be an overflow. */
#include "drivers/u3v/layout.h"

#include "drivers/u3v/wire/packet.h"
#include "drivers/u3v/wire/registers.h"

#define TRANSFER_MAX_BYTES ((size_t)1 << 20)
#define PACKET_MAX_BYTES 1024u
#define ALIGNMENT_LOG2_MAX 20 /* of which one transfer can still be a multiple */
#define HEADER_MAX_BYTES 65536u
/* Cameras ask for more than the samples where chunks or padding come with them; this much more is
 * an error, or an attempt on our memory. */
#define SPARE_FACTOR 4
#define SPARE_BYTES ((size_t)1 << 20)

static size_t align_up(size_t bytes, size_t alignment) {
  return (bytes + alignment - 1) / alignment * alignment;
}

struct required {
  uint32_t info, leader, trailer;
  uint64_t payload;
};

static int read_required(struct required *required, placido_u3v_channel *channel,
                         uint64_t address, placido_error *err) {
  int status =
      placido_u3v_channel_read_u32(channel, address + PLACIDO_SIRM_INFO, &required->info, err);
  if (!status) {
    status = placido_u3v_channel_read_u64(channel, address + PLACIDO_SIRM_REQUIRED_PAYLOAD,
                                          &required->payload, err);
  }
  if (!status) {
    status = placido_u3v_channel_read_u32(channel, address + PLACIDO_SIRM_REQUIRED_LEADER,
                                          &required->leader, err);
  }
  if (!status) {
    status = placido_u3v_channel_read_u32(channel, address + PLACIDO_SIRM_REQUIRED_TRAILER,
                                          &required->trailer, err);
  }
  return status;
}

static int check_required(const struct required *required, size_t picture_bytes,
                          placido_error *err) {
  if (required->info >> 24 > ALIGNMENT_LOG2_MAX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera asks for transfers in multiples of 2^%u bytes",
                             (unsigned)(required->info >> 24));
  }
  if (required->leader < PLACIDO_U3V_LEADER_BYTES || required->leader > HEADER_MAX_BYTES ||
      required->trailer < 28 || required->trailer > HEADER_MAX_BYTES) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's leader has %u bytes and its trailer %u: not a picture's",
                             (unsigned)required->leader, (unsigned)required->trailer);
  }
  if (required->payload < picture_bytes ||
      required->payload > SPARE_FACTOR * picture_bytes + SPARE_BYTES) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera sends %llu bytes for a picture of %zu",
                             (unsigned long long)required->payload, picture_bytes);
  }
  return PLACIDO_OK;
}

static placido_u3v_layout lay_out(const struct required *required) {
  const size_t asked = (size_t)1 << (required->info >> 24);
  const size_t alignment = asked > PACKET_MAX_BYTES ? asked : PACKET_MAX_BYTES;
  const size_t payload = (size_t)required->payload, aligned = align_up(payload, alignment);
  placido_u3v_layout layout = {
      .required_bytes = payload,
      .leader_bytes = align_up(required->leader, alignment),
      .trailer_bytes = align_up(required->trailer, alignment),
      .transfer_bytes = aligned < TRANSFER_MAX_BYTES ? aligned : TRANSFER_MAX_BYTES};
  layout.transfer_count = payload / layout.transfer_bytes;
  layout.final_bytes =
      align_up(payload - layout.transfer_count * layout.transfer_bytes, alignment);
  return layout;
}

int placido_u3v_layout_agree(placido_u3v_layout *layout, placido_u3v_channel *channel,
                             uint64_t sirm_address, size_t picture_bytes, placido_error *err) {
  *layout = (placido_u3v_layout){0};
  struct required required = {0};
  int status = read_required(&required, channel, sirm_address, err);
  status = status ? status : check_required(&required, picture_bytes, err);
  if (status) {
    return status;
  }
  *layout = lay_out(&required);
  const struct {
    uint64_t offset;
    size_t value;
  } writes[] = {
      {PLACIDO_SIRM_MAX_LEADER, layout->leader_bytes},
      {PLACIDO_SIRM_MAX_TRAILER, layout->trailer_bytes},
      {PLACIDO_SIRM_PAYLOAD_SIZE, layout->transfer_bytes},
      {PLACIDO_SIRM_PAYLOAD_COUNT, layout->transfer_count},
      {PLACIDO_SIRM_FINAL1, layout->final_bytes},
      {PLACIDO_SIRM_FINAL2, 0},
  };
  for (size_t i = 0; !status && i < sizeof writes / sizeof *writes; i++) {
    status = placido_u3v_channel_write_u32(channel, sirm_address + writes[i].offset,
                                           (uint32_t)writes[i].value, err);
  }
  return status;
}

size_t placido_u3v_layout_block_bytes(const placido_u3v_layout *layout) {
  return layout->transfer_count * layout->transfer_bytes + layout->final_bytes;
}

size_t placido_u3v_layout_transfers(const placido_u3v_layout *layout) {
  return layout->transfer_count + (layout->final_bytes > 0) + 2;
}

size_t placido_u3v_layout_transfer_bytes(const placido_u3v_layout *layout, size_t index) {
  if (index == 0) {
    return layout->leader_bytes;
  }
  if (index + 1 == placido_u3v_layout_transfers(layout)) {
    return layout->trailer_bytes;
  }
  return index <= layout->transfer_count ? layout->transfer_bytes : layout->final_bytes;
}
