/* Which codec follows a camera. */
#ifndef PLACIDO_ACQUIRE_CODEC_H
#define PLACIDO_ACQUIRE_CODEC_H

#include <placido/session.h>

/* FFV1 where it holds so many bytes of samples a second (NaN: not known, which it does not) on so
 * many processors, with half of each left for the camera and what looks on; else FFVHUFF. */
enum placido_session_codec placido_codec_choose(double bytes_per_s, long processors);

#endif
