/* A session's parts, for what looks after sessions. */
#ifndef PLACIDO_BASE_SESSION_READER_H
#define PLACIDO_BASE_SESSION_READER_H

#include "base/session/frames_log.h"
#include "base/session/video.h"

#include <placido/session.h>

/* As placido_session_reader_open, but session.json and instrument.json may be missing or wrong,
 * which is noted. */
int placido_session_reader_open_torn(placido_session_reader **reader, const char *path,
                                     placido_notes *notes, placido_error *err);

/* Borrowed until the reader is closed; the video until it is rewound. */
const placido_frames_log *placido_session_reader_log(const placido_session_reader *reader);
placido_video_reader *placido_session_reader_video(const placido_session_reader *reader);

/* Whether the video has its end. */
bool placido_session_reader_is_finished(const placido_session_reader *reader);

#endif
