/* What is done with a session after it was recorded: checked, described, packed, repaired,
 * exported. No function changes the session that it is given but placido_pack_commit. */
#ifndef PLACIDO_BASE_SESSION_ARCHIVE_H
#define PLACIDO_BASE_SESSION_ARCHIVE_H

#include "base/file.h"
#include "base/session/clock.h"
#include "base/session/ranges.h"

#include <placido/notes.h>
#include <placido/session.h>
#include <placido/status.h>

#define PLACIDO_FINDINGS_MAX 48
#define PLACIDO_PACK_FOLDER "frames-new"

/* The figures of a session. */
typedef struct placido_session_survey {
  placido_session_info info;
  char codec[32]; /* FFmpeg's name */
  char instrument[128];
  bool calibrated;
  bool is_finished;         /* frames.mkv has its end */
  int width_px, height_px;  /* 0: no frame could be read */
  int64_t frames, damaged;  /* in frames.mkv; of those, not whole */
  int64_t lines, events;    /* in frames.jsonl, events.jsonl */
  int64_t bytes;            /* of frames.mkv */
  placido_clock_figures clock;
} placido_session_survey;

/* Opens the session and counts what is in it, without decoding more than the first frame: `damaged`
 * stays 0, and the clock is that of frames.jsonl. Errors as placido_session_reader_open. */
int placido_session_survey_take(placido_session_survey *survey, const char *path,
                                placido_notes *notes, placido_error *err);

enum placido_finding_state {
  PLACIDO_FINDING_SOUND,
  PLACIDO_FINDING_NOTE,   /* worth knowing; the session is sound all the same */
  PLACIDO_FINDING_DAMAGE, /* something that was recorded is lost or cannot be trusted */
};

typedef struct placido_finding {
  enum placido_finding_state state;
  char part[24]; /* a file, "sequence" or "clock" */
  char text[256];
} placido_finding;

typedef struct placido_findings {
  placido_finding items[PLACIDO_FINDINGS_MAX];
  size_t count;
  size_t damage; /* how many are of that state */
} placido_findings;

/* Reads everything and decodes every frame. PLACIDO_OK however bad the findings are;
 * PLACIDO_SYSTEM (no such folder), PLACIDO_MEMORY, PLACIDO_UNSUPPORTED. */
int placido_session_check(placido_findings *findings, placido_session_survey *survey,
                          const char *path, placido_error *err);

/* What packing did. */
typedef struct placido_pack_summary {
  int64_t frames, bytes_before, bytes_after;
} placido_pack_summary;

/* Whether frames.mkv is FFV1 with checksums already. */
int placido_pack_is_needed(bool *needed, const char *path, placido_error *err);

/* Writes the frames of session `path` as FFV1 into FOLDER/frames.mkv, puts it on the disk, decodes
 * it again, and compares every frame bit for bit. Of a session that is torn or damaged nothing is
 * packed: PLACIDO_INPUT. */
int placido_pack_video(placido_pack_summary *summary, const char *path, const char *folder,
                       placido_error *err);

/* Everything else of the session into `folder`. */
int placido_pack_rest(const char *path, const char *folder, placido_notes *notes,
                      placido_error *err);

/* Packing in place. Takes hold of the session, so that no other process packs it as well, and makes
 * the folder frames-new in it (what an earlier packing left there is removed): its path is
 * workshop->temporary, so that placido_directory_discard removes it. `*lock` is to be given to
 * placido_pack_end, after failure too. */
int placido_pack_begin(int *lock, placido_directory *workshop, const char *path,
                       placido_error *err);
/* Puts frames-new/frames.mkv in the place of frames.mkv, at one stroke, and on the disk. */
int placido_pack_commit(placido_directory *workshop, const char *path, placido_error *err);
void placido_pack_end(int lock);

/* What a repair kept and what it could not. Free with placido_repair_summary_free. */
typedef struct placido_repair_summary {
  int64_t kept;
  placido_ranges lost;  /* numbers of frames that are damaged or missing within the video */
  int64_t cut_off;      /* frames that frames.jsonl has beyond the video's end */
  int64_t bad_lines, bad_events;
  bool has_description; /* session.json was sound */
} placido_repair_summary;

/* Writes what is whole in session `path` as a new session `target` (which must not exist), every
 * frame as FFV1, and reads it all once more. `instrument_path` takes the place of the session's own
 * instrument; NULL: that one. PLACIDO_INPUT: no frame is whole, or the instrument is not. */
int placido_session_repair(placido_repair_summary *summary, const char *path, const char *target,
                           const char *instrument_path, placido_notes *notes, placido_error *err);
void placido_repair_summary_free(placido_repair_summary *summary);

enum placido_export_type { PLACIDO_EXPORT_PNG, PLACIDO_EXPORT_TIFF };

/* Writes frames as FOLDER/frame-000003.png: 8 or 16 bit, every sample as it is. `wanted` empty: all
 * of them; damaged ones are then left out with a note. PLACIDO_INPUT: a wanted one is damaged or
 * not there. `*count` is how many were written. */
int placido_session_export(int64_t *count, const char *path, const char *folder,
                           const placido_ranges *wanted, enum placido_export_type type,
                           placido_notes *notes, placido_error *err);

#endif
