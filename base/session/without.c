/* What a build without FFmpeg says where a session is asked for. */
#include <placido/session.h>

#include <stddef.h>

static int refuse(placido_error *err) {
  return placido_error_set(err, PLACIDO_UNSUPPORTED,
                           "sessions cannot be read or written: this build is without FFmpeg "
                           "(PLACIDO_SESSIONS)");
}

int placido_session_reader_open(placido_session_reader **reader, const char *path,
                                placido_notes *notes, placido_error *err) {
  (void)path;
  (void)notes;
  *reader = NULL;
  return refuse(err);
}

const placido_session_info *placido_session_reader_info(const placido_session_reader *reader) {
  (void)reader;
  return NULL;
}

const char *placido_session_reader_instrument(const placido_session_reader *reader) {
  (void)reader;
  return NULL;
}

int placido_session_reader_next(placido_session_reader *reader, placido_frame *frame,
                                placido_error *err) {
  (void)reader;
  (void)frame;
  return refuse(err);
}

placido_frame_info placido_session_reader_frame_info(const placido_session_reader *reader) {
  (void)reader;
  return (placido_frame_info){0};
}

int placido_session_reader_rewind(placido_session_reader *reader, placido_error *err) {
  (void)reader;
  return refuse(err);
}

void placido_session_reader_close(placido_session_reader *reader) {
  (void)reader;
}

int placido_session_writer_create(placido_session_writer **writer, const char *path,
                                  const placido_session_info *info, const char *instrument_path,
                                  placido_error *err) {
  (void)path;
  (void)info;
  (void)instrument_path;
  *writer = NULL;
  return refuse(err);
}

int placido_session_writer_append(placido_session_writer *writer, const placido_frame *frame,
                                  const placido_frame_info *frame_info, placido_error *err) {
  (void)writer;
  (void)frame;
  (void)frame_info;
  return refuse(err);
}

int placido_session_writer_event(placido_session_writer *writer, int64_t t_ns, const char *name,
                                 const char *text, placido_error *err) {
  (void)writer;
  (void)t_ns;
  (void)name;
  (void)text;
  return refuse(err);
}

int placido_session_writer_close(placido_session_writer *writer, placido_error *err) {
  (void)writer;
  return refuse(err);
}
