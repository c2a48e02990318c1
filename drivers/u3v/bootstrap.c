/* Who the camera is and where its registers lie. */
#include "drivers/u3v/bootstrap.h"

#include "drivers/u3v/wire/registers.h"

/* A register that old cameras do without is left as it is where the camera refuses. */
static int forgive(int status) {
  return status == PLACIDO_UNSUPPORTED ? PLACIDO_OK : status;
}

/* A string register: ended, and fit for a line whatever the camera holds there. */
static int read_text(char text[64], placido_u3v_channel *channel, uint64_t address,
                     placido_error *err) {
  char said[64];
  text[0] = '\0';
  const int status = placido_u3v_channel_read(channel, address, said, sizeof said, err);
  if (status) {
    return forgive(status);
  }
  size_t length = 0;
  for (; length < sizeof said - 1 && said[length]; length++) {
    text[length] = said[length] >= ' ' && said[length] <= '~' ? said[length] : '?';
  }
  while (length > 0 && text[length - 1] == ' ') {
    length--;
  }
  text[length] = '\0';
  return PLACIDO_OK;
}

static int read_texts(placido_u3v_bootstrap *bootstrap, placido_u3v_channel *channel,
                      placido_error *err) {
  const struct {
    char *text;
    uint64_t address;
  } texts[] = {
      {bootstrap->vendor, PLACIDO_ABRM_MANUFACTURER},
      {bootstrap->model, PLACIDO_ABRM_MODEL},
      {bootstrap->version, PLACIDO_ABRM_DEVICE_VERSION},
      {bootstrap->serial, PLACIDO_ABRM_SERIAL},
      {bootstrap->user_name, PLACIDO_ABRM_USER_NAME},
  };
  int status = PLACIDO_OK;
  for (size_t i = 0; !status && i < sizeof texts / sizeof *texts; i++) {
    status = read_text(texts[i].text, channel, texts[i].address, err);
  }
  return status;
}

/* Where the stream's registers lie. */
static int find_stream(placido_u3v_bootstrap *bootstrap, placido_u3v_channel *channel,
                       placido_error *err) {
  const uint64_t sbrm = bootstrap->sbrm_address;
  uint32_t channels = 0;
  int status =
      placido_u3v_channel_read_u32(channel, sbrm + PLACIDO_SBRM_STREAM_CHANNELS, &channels, err);
  if (!status && channels > 0) {
    status = placido_u3v_channel_read_u64(channel, sbrm + PLACIDO_SBRM_SIRM_ADDRESS,
                                          &bootstrap->sirm_address, err);
  }
  if (status) {
    return status;
  }
  if (bootstrap->sirm_address == 0 ||
      bootstrap->sirm_address > UINT64_MAX - PLACIDO_SIRM_BYTES) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera %s %s has no stream: it gives no pictures",
                             bootstrap->vendor, bootstrap->model);
  }
  return PLACIDO_OK;
}

int placido_u3v_bootstrap_read(placido_u3v_bootstrap *bootstrap, placido_u3v_channel *channel,
                               placido_error *err) {
  *bootstrap = (placido_u3v_bootstrap){0};
  int status = read_texts(bootstrap, channel, err);
  if (!status) {
    status = forgive(placido_u3v_channel_read_u64(channel, PLACIDO_ABRM_TIMESTAMP_INCREMENT,
                                                  &bootstrap->timestamp_increment_ns, err));
  }
  if (!status) {
    status = placido_u3v_channel_read_u64(channel, PLACIDO_ABRM_SBRM_ADDRESS,
                                          &bootstrap->sbrm_address, err);
  }
  return status ? status : find_stream(bootstrap, channel, err);
}
