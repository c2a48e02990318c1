/* Small recorded sessions for tests. */
#ifndef PLACIDO_TESTS_BASE_RECORDING_H
#define PLACIDO_TESTS_BASE_RECORDING_H

#include <placido/frame.h>
#include <placido/session.h>

/* The instrument file that every recording copies. */
#define RECORDING_INSTRUMENT PLACIDO_TEST_DATA "/samples/normal.instrument.json"

/* Frame number `index` of every recording: noise that no lossy codec would keep, 40 ms apart. */
void recording_fill(placido_frame *frame, int index, enum placido_format format, int bits,
                    int width_px, int height_px);

/* Fails the test where `frame` is not that frame. */
void recording_assert_frame(const placido_frame *frame, int index, enum placido_format format,
                            int bits, int width_px, int height_px);

/* A session's info of a format, else not recorded. */
placido_session_info recording_info(enum placido_format format, int bits);

/* Records `count` frames into a new session and closes it. The second stores them in a codec. */
void recording_make(const char *path, int count, enum placido_format format, int bits,
                    int width_px, int height_px);
void recording_make_in(enum placido_session_codec codec, const char *path, int count,
                       enum placido_format format, int bits, int width_px, int height_px);

/* A file of a session, read (free with placido_memory_free); written anew. */
char *recording_take(const char *session, const char *name, size_t *size);
void recording_put(const char *session, const char *name, const char *bytes, size_t size);

#endif
