/* Which codec follows a camera: a rule, not a measurement, so that one machine always records one
 * camera alike. */
#include "acquire/codec.h"

/* Noisy frames on one core of 2.8 GHz: 23 MB/s, of which half is counted on. */
#define FFV1_BYTES_PER_S 12e6

enum placido_session_codec placido_codec_choose(double bytes_per_s, long processors) {
  const double held = FFV1_BYTES_PER_S * (double)(processors > 1 ? processors : 1);
  return bytes_per_s <= held ? PLACIDO_CODEC_FFV1 : PLACIDO_CODEC_FFVHUFF;
}
