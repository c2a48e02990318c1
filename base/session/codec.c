/* What the ways to store frames are called. */
#include <placido/session.h>

#include <stddef.h>

const char *placido_session_codec_name(enum placido_session_codec codec) {
  static const char *const names[] = {[PLACIDO_CODEC_FFV1] = "ffv1",
                                      [PLACIDO_CODEC_FFVHUFF] = "ffvhuff",
                                      [PLACIDO_CODEC_RAW] = "raw",
                                      [PLACIDO_CODEC_OTHER] = "other"};
  return names[codec];
}
