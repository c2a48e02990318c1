/* What a build without FFmpeg says where a session is to be looked after. */
#include "base/session/archive.h"

static int refuse(placido_error *err) {
  return placido_error_set(err, PLACIDO_UNSUPPORTED,
                           "sessions cannot be read or written: this build is without FFmpeg "
                           "(PLACIDO_SESSIONS)");
}

int placido_session_survey_take(placido_session_survey *survey, const char *path,
                                placido_notes *notes, placido_error *err) {
  (void)path;
  (void)notes;
  *survey = (placido_session_survey){0};
  return refuse(err);
}

int placido_session_check(placido_findings *findings, placido_session_survey *survey,
                          const char *path, placido_error *err) {
  (void)path;
  *findings = (placido_findings){0};
  *survey = (placido_session_survey){0};
  return refuse(err);
}

int placido_pack_is_needed(bool *needed, const char *path, placido_error *err) {
  (void)path;
  *needed = false;
  return refuse(err);
}

int placido_pack_video(placido_pack_summary *summary, const char *path, const char *folder,
                       placido_error *err) {
  (void)path;
  (void)folder;
  *summary = (placido_pack_summary){0};
  return refuse(err);
}

int placido_pack_rest(const char *path, const char *folder, placido_notes *notes,
                      placido_error *err) {
  (void)path;
  (void)folder;
  (void)notes;
  return refuse(err);
}

int placido_pack_begin(int *lock, placido_directory *workshop, const char *path,
                       placido_error *err) {
  (void)path;
  *lock = -1;
  *workshop = (placido_directory){0};
  return refuse(err);
}

int placido_pack_commit(placido_directory *workshop, const char *path, placido_error *err) {
  (void)workshop;
  (void)path;
  return refuse(err);
}

void placido_pack_end(int lock) {
  (void)lock;
}

int placido_session_repair(placido_repair_summary *summary, const char *path, const char *target,
                           const char *instrument_path, placido_notes *notes,
                           placido_error *err) {
  (void)path;
  (void)target;
  (void)instrument_path;
  (void)notes;
  *summary = (placido_repair_summary){0};
  return refuse(err);
}

void placido_repair_summary_free(placido_repair_summary *summary) {
  (void)summary;
}

int placido_session_export(int64_t *count, const char *path, const char *folder,
                           const placido_ranges *wanted, enum placido_export_type type,
                           placido_notes *notes, placido_error *err) {
  (void)path;
  (void)folder;
  (void)wanted;
  (void)type;
  (void)notes;
  *count = 0;
  return refuse(err);
}
