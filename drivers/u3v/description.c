/* The camera's own description: an XML file, zipped or not, that its manifest points to. */
#include "drivers/u3v/bootstrap.h"

#include "base/memory.h"
#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/registers.h"

#include <string.h>
#include <strings.h>
#include <zip.h>

#define ENTRIES_MAX 16 /* of the manifest; cameras have one or two */

/* An entry of the manifest. */
struct entry {
  uint64_t rank; /* the greater, the better */
  uint64_t address, size;
};

/* XML and zip before other kinds of files, files that describe the device before others, then by
 * version: of the schema, of the file. */
static uint64_t rank_of(const uint8_t bytes[PLACIDO_MANIFEST_ENTRY_BYTES]) {
  const uint32_t version = placido_read_u32(bytes);
  const uint32_t schema = placido_read_u32(bytes + PLACIDO_MANIFEST_SCHEMA);
  const uint64_t is_known = PLACIDO_MANIFEST_TYPE(schema) <= 1;
  const uint64_t is_device = (schema & 7) == 0;
  return is_known << 63 | is_device << 62 | (uint64_t)(schema >> 16) << 32 | version;
}

static int read_entry(struct entry *entry, placido_u3v_channel *channel, uint64_t address,
                      placido_error *err) {
  uint8_t bytes[PLACIDO_MANIFEST_ENTRY_BYTES];
  const int status = placido_u3v_channel_read(channel, address, bytes, sizeof bytes, err);
  if (!status) {
    *entry = (struct entry){.rank = rank_of(bytes),
                            .address = placido_read_u64(bytes + PLACIDO_MANIFEST_ADDRESS),
                            .size = placido_read_u64(bytes + PLACIDO_MANIFEST_SIZE)};
  }
  return status;
}

/* Puts an entry in its place among `count` others, the best first. */
static void insert(struct entry *entries, size_t count, struct entry entry) {
  size_t place = count;
  for (; place > 0 && entries[place - 1].rank < entry.rank; place--) {
    entries[place] = entries[place - 1];
  }
  entries[place] = entry;
}

static int read_manifest(struct entry entries[ENTRIES_MAX], size_t *count,
                         placido_u3v_channel *channel, placido_error *err) {
  *count = 0;
  uint64_t address = 0, told = 0;
  int status = placido_u3v_channel_read_u64(channel, PLACIDO_ABRM_MANIFEST_ADDRESS, &address, err);
  if (!status && (address == 0 || address > UINT64_MAX - 8 - ENTRIES_MAX *
                                                             PLACIDO_MANIFEST_ENTRY_BYTES)) {
    status = placido_error_set(err, PLACIDO_INPUT,
                               "the camera's list of descriptions cannot be at 0x%llx",
                               (unsigned long long)address);
  }
  if (!status) {
    status = placido_u3v_channel_read_u64(channel, address, &told, err);
  }
  if (!status && told == 0) {
    status = placido_error_set(err, PLACIDO_INPUT, "the camera has no description of itself");
  }
  for (size_t i = 0; !status && i < told && i < ENTRIES_MAX; i++) {
    struct entry entry;
    status = read_entry(&entry, channel, address + 8 + i * PLACIDO_MANIFEST_ENTRY_BYTES, err);
    if (!status) {
      insert(entries, (*count)++, entry);
    }
  }
  return status;
}

static int check_size(uint64_t size, const char *what, placido_error *err) {
  return size > 0 && size <= PLACIDO_U3V_XML_BYTES_MAX
             ? PLACIDO_OK
             : placido_error_set(err, PLACIDO_INPUT,
                                 "the camera's %s has %llu bytes; 1 to %u are possible", what,
                                 (unsigned long long)size, PLACIDO_U3V_XML_BYTES_MAX);
}

/* The bytes that an entry points to, with a 0 behind them. */
static int read_file(char **bytes, placido_u3v_channel *channel, const struct entry *entry,
                     placido_error *err) {
  *bytes = NULL;
  int status = check_size(entry->size, "description", err);
  if (!status && entry->address > UINT64_MAX - entry->size) {
    status = placido_error_set(err, PLACIDO_INPUT, "the camera's description cannot be at 0x%llx",
                               (unsigned long long)entry->address);
  }
  if (status) {
    return status;
  }
  char *file = placido_memory_new((size_t)entry->size + 1, 1, err);
  if (!file) {
    return PLACIDO_MEMORY;
  }
  status = placido_u3v_channel_read(channel, entry->address, file, (size_t)entry->size, err);
  if (status) {
    placido_memory_free(file);
    return status;
  }
  *bytes = file;
  return PLACIDO_OK;
}

/* The first file of the archive whose name ends as XML files' do; else the first of all. */
static zip_uint64_t choose_member(zip_t *archive) {
  const zip_int64_t count = zip_get_num_entries(archive, 0);
  for (zip_int64_t i = 0; i < count; i++) {
    const char *name = zip_get_name(archive, (zip_uint64_t)i, ZIP_FL_ENC_RAW);
    const size_t length = name ? strlen(name) : 0;
    if (length >= 4 && strcasecmp(name + length - 4, ".xml") == 0) {
      return (zip_uint64_t)i;
    }
  }
  return 0;
}

/* A member of the archive as large as it says, not a byte more. */
static int read_member(char **xml, size_t *size, zip_t *archive, placido_error *err) {
  const zip_uint64_t member = choose_member(archive);
  zip_stat_t stat;
  if (zip_stat_index(archive, member, 0, &stat) != 0 || !(stat.valid & ZIP_STAT_SIZE)) {
    return placido_error_set(err, PLACIDO_INPUT, "the camera's zipped description is empty");
  }
  const int status = check_size(stat.size, "unzipped description", err);
  if (status) {
    return status;
  }
  char *text = placido_memory_new((size_t)stat.size + 1, 1, err);
  if (!text) {
    return PLACIDO_MEMORY;
  }
  zip_file_t *file = zip_fopen_index(archive, member, 0);
  const zip_int64_t got = file ? zip_fread(file, text, stat.size) : -1;
  /* The checksum is looked at where the end is met. */
  char beyond;
  const zip_int64_t rest = got >= 0 ? zip_fread(file, &beyond, 1) : -1;
  if (file) {
    zip_fclose(file);
  }
  if (got < 0 || (zip_uint64_t)got != stat.size || rest != 0) {
    placido_memory_free(text);
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's zipped description is damaged");
  }
  *xml = text;
  *size = (size_t)stat.size;
  return PLACIDO_OK;
}

static int unzip(char **xml, size_t *size, const char *bytes, size_t byte_count,
                 placido_error *err) {
  zip_source_t *source = zip_source_buffer_create(bytes, byte_count, 0, NULL);
  if (!source) {
    return placido_error_set(err, PLACIDO_MEMORY, "no memory to unzip the camera's description");
  }
  zip_t *archive = zip_open_from_source(source, ZIP_RDONLY, NULL);
  if (!archive) {
    zip_source_free(source);
    return placido_error_set(err, PLACIDO_INPUT, "the camera's zipped description is damaged");
  }
  const int status = read_member(xml, size, archive, err);
  zip_discard(archive);
  return status;
}

/* XML as it is, but for the zeros that fill up its place in the camera. */
static int take_as_text(char **xml, size_t *size, char *bytes, size_t byte_count,
                        placido_error *err) {
  while (byte_count > 0 && bytes[byte_count - 1] == '\0') {
    byte_count--;
  }
  if (!memchr(bytes, '<', byte_count)) {
    placido_memory_free(bytes);
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's description is neither XML nor a zip");
  }
  *xml = bytes;
  *size = byte_count;
  return PLACIDO_OK;
}

/* What a file is, its first bytes tell: some cameras' manifests are wrong about it. */
static int read_description(char **xml, size_t *size, placido_u3v_channel *channel,
                            const struct entry *entry, placido_error *err) {
  char *bytes;
  int status = read_file(&bytes, channel, entry, err);
  if (status) {
    return status;
  }
  const size_t byte_count = (size_t)entry->size;
  if (byte_count < 4 || memcmp(bytes, "PK\3\4", 4) != 0) {
    return take_as_text(xml, size, bytes, byte_count, err);
  }
  status = unzip(xml, size, bytes, byte_count, err);
  placido_memory_free(bytes);
  return status;
}

int placido_u3v_description_read(char **xml, size_t *size, placido_u3v_channel *channel,
                                 placido_error *err) {
  *xml = NULL;
  *size = 0;
  struct entry entries[ENTRIES_MAX];
  size_t count;
  int status = read_manifest(entries, &count, channel, err);
  if (status) {
    return status;
  }
  status = PLACIDO_INPUT;
  for (size_t i = 0; i < count && (status == PLACIDO_INPUT || status == PLACIDO_UNSUPPORTED); i++) {
    status = read_description(xml, size, channel, &entries[i], err);
  }
  return status;
}
