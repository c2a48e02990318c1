/* Depth maps as OpenEXR files: one part of scan lines, the channel Z (or Y, or the only one). */
#include "simulate/depth/map.h"

#include "base/memory.h"

#include <openexr.h>
#include <string.h>

/* What the library says goes into our own line, not to standard error. */
static void say_nothing(exr_const_context_t context, exr_result_t code, const char *message) {
  (void)context;
  (void)code;
  (void)message;
}

static void *new_block(size_t bytes) {
  return placido_memory_new(1, bytes, NULL);
}

static int64_t read_bytes(exr_const_context_t context, void *user, void *buffer, uint64_t bytes,
                          uint64_t offset, exr_stream_error_func_ptr_t fail) {
  const placido_depth_file *file = user;
  (void)context;
  (void)fail;
  if (offset > file->size) {
    return -1;
  }
  uint64_t left = file->size - offset, count = bytes < left ? bytes : left;
  memcpy(buffer, file->bytes + offset, (size_t)count);
  return (int64_t)count;
}

static int64_t tell_size(exr_const_context_t context, void *user) {
  const placido_depth_file *file = user;
  (void)context;
  return (int64_t)file->size;
}

static int refuse(const placido_depth_file *file, exr_result_t code, placido_error *err) {
  if (code == EXR_ERR_OUT_OF_MEMORY) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory: %s", file->name);
  }
  return placido_error_set(err, PLACIDO_INPUT, "%s: the EXR file cannot be read: %s", file->name,
                           exr_get_error_code_as_string(code));
}

/* "Z" itself and that of a layer ("View Layer.Depth.Z"). */
static bool is_called(const exr_attr_string_t *channel, char letter) {
  return channel->length > 0 && channel->str[channel->length - 1] == letter &&
         (channel->length == 1 || channel->str[channel->length - 2] == '.');
}

/* The number of the channel with distances, -1: none. */
static int find_channel(const exr_attr_chlist_t *channels) {
  const char letters[] = {'Z', 'Y'};
  for (size_t k = 0; k < sizeof letters; k++) {
    for (int i = 0; i < channels->num_channels; i++) {
      if (is_called(&channels->entries[i].name, letters[k])) {
        return i;
      }
    }
  }
  return channels->num_channels == 1 ? 0 : -1;
}

/* What kind of EXR file it is, and whether that will do. `channel` receives which one to read. */
static int check(int *channel, exr_context_t context, const placido_depth_file *file,
                 const int size[2], placido_error *err) {
  exr_storage_t storage = EXR_STORAGE_SCANLINE;
  const exr_attr_chlist_t *channels = NULL;
  exr_attr_box2i_t window = {.min.x = 0};
  exr_result_t code = exr_get_storage(context, 0, &storage);
  if (code == EXR_ERR_SUCCESS) {
    code = exr_get_channels(context, 0, &channels);
  }
  if (code == EXR_ERR_SUCCESS) {
    code = exr_get_data_window(context, 0, &window);
  }
  if (code != EXR_ERR_SUCCESS) {
    return refuse(file, code, err);
  }
  if (storage != EXR_STORAGE_SCANLINE) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: tiles or deep samples, expected scan lines",
                             file->name);
  }
  *channel = find_channel(channels);
  const exr_attr_chlist_entry_t *entry = *channel < 0 ? NULL : &channels->entries[*channel];
  if (entry == NULL || entry->pixel_type == EXR_PIXEL_UINT || entry->x_sampling != 1 ||
      entry->y_sampling != 1) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s: expected a channel Z (or Y) of floating point in every pixel",
                             file->name);
  }
  return placido_depth_check_size(file, 1 + (long)window.max.x - window.min.x,
                                  1 + (long)window.max.y - window.min.y, size, err);
}

/* Where one channel of a chunk goes; the others are passed over. */
static void aim(exr_decode_pipeline_t *decode, int channel, placido_image *metres, size_t row) {
  for (int i = 0; i < decode->channel_count; i++) {
    exr_coding_channel_info_t *to = &decode->channels[i];
    to->decode_to_ptr = NULL;
    if (i == channel) {
      to->decode_to_ptr = (uint8_t *)&metres->data[row * (size_t)metres->width_px];
      to->user_bytes_per_element = sizeof *metres->data;
      to->user_data_type = EXR_PIXEL_FLOAT;
      to->user_pixel_stride = sizeof *metres->data;
      to->user_line_stride = metres->width_px * (int32_t)sizeof *metres->data;
    }
  }
}

/* Chunk by chunk of some lines. */
static exr_result_t read_lines(placido_image *metres, exr_context_t context, int channel) {
  exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
  exr_attr_box2i_t window;
  int32_t lines = 1;
  exr_result_t code = exr_get_data_window(context, 0, &window);
  if (code == EXR_ERR_SUCCESS) {
    code = exr_get_scanlines_per_chunk(context, 0, &lines);
  }
  for (int row = 0; row < metres->height_px && code == EXR_ERR_SUCCESS; row += lines) {
    exr_chunk_info_t chunk;
    code = exr_read_scanline_chunk_info(context, 0, window.min.y + row, &chunk);
    if (code == EXR_ERR_SUCCESS) {
      code = row == 0 ? exr_decoding_initialize(context, 0, &chunk, &decode)
                      : exr_decoding_update(context, 0, &chunk, &decode);
    }
    if (code == EXR_ERR_SUCCESS) {
      aim(&decode, channel, metres, (size_t)row);
      code = row == 0 ? exr_decoding_choose_default_routines(context, 0, &decode) : code;
    }
    if (code == EXR_ERR_SUCCESS) {
      code = exr_decoding_run(context, 0, &decode);
    }
  }
  exr_decoding_destroy(context, &decode);
  return code;
}

int placido_depth_read_exr(placido_image *metres, const placido_depth_file *file, const int size[2],
                           placido_error *err) {
  exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
  exr_context_t context = NULL;
  placido_depth_file stream = *file;
  int channel = -1;
  *metres = (placido_image){0};
  how.error_handler_fn = say_nothing;
  how.alloc_fn = new_block;
  how.free_fn = placido_memory_free;
  how.user_data = &stream;
  how.read_fn = read_bytes;
  how.size_fn = tell_size;
  how.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
  exr_result_t code = exr_start_read(&context, file->name, &how);
  int status = code == EXR_ERR_SUCCESS ? check(&channel, context, file, size, err)
                                       : refuse(file, code, err);
  if (status == PLACIDO_OK) {
    status = placido_image_new(metres, size[0], size[1], 1, err);
  }
  if (status == PLACIDO_OK) {
    code = read_lines(metres, context, channel);
    status = code == EXR_ERR_SUCCESS ? PLACIDO_OK : refuse(file, code, err);
  }
  if (status != PLACIDO_OK) {
    placido_image_free(metres);
  }
  exr_finish(&context);
  return status;
}
