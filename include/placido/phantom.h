/* A forward model of the topographer: analytic surface and instrument in, mire image or session
 * out. Written for tests and the demo; shares no ray code with the reconstruction. */
#ifndef PLACIDO_PHANTOM_H
#define PLACIDO_PHANTOM_H

#include <placido/frame.h>
#include <placido/instrument.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <stdbool.h>
#include <stdint.h>

/* How the picture is disturbed. Zero means none, but for the defaults in brackets. */
typedef struct placido_disturbance {
  uint64_t seed;         /* of everything random */
  int subsamples;        /* n×n rays in a pixel that an edge crosses [4] */
  double blur_px;        /* defocus: standard deviation of a Gaussian */
  double motion_px;      /* length of a linear motion blur */
  double motion_deg;     /* and its direction */
  double noise;          /* standard deviation of sensor noise, in grey levels of 8 bits */
  int lashes;            /* how many, 0 to 1000 */
  bool nose, lid;        /* the nose's shadow; a drooping upper lid */
  double break_up;       /* share of the inner 10 mm where the tear film is broken, 0 to 0.5 */
  double shift_mm[3];    /* movement of the whole eye from where the surface says */
  int bits;              /* [8], or 9 to 16: MONO16 */
} placido_disturbance;

/* Renders one frame. `frame` is the caller's. `disturbance` may be NULL (none). `threads`: 0 for
 * all there are; the picture does not depend on it. Returns PLACIDO_OK, PLACIDO_INPUT (a quantity
 * out of its range, named), PLACIDO_MEMORY. */
int placido_phantom_render(placido_frame *frame, const placido_surface *surface,
                           const placido_instrument *instrument,
                           const placido_disturbance *disturbance, int threads,
                           placido_error *err);

/* Where edge `edge` of the instrument is seen along a meridian, without an image: the exact
 * position by bisection on the forward trace, within 1e-6 px. Returns false, and a position of NaN,
 * where it is not seen. `centre_px` is the image point about which the meridian (degrees, +x
 * towards +y) runs. Where it crosses the circle more than once, the innermost way out counts. */
bool placido_phantom_edge_at(const placido_surface *surface, const placido_instrument *instrument,
                             int edge, const double centre_px[2], double meridian_deg,
                             double position_px[2]);

/* The same for all edges of the instrument in one walk: a position each, NaN where it is not seen.
 */
void placido_phantom_edges_at(const placido_surface *surface, const placido_instrument *instrument,
                              const double centre_px[2], double meridian_deg,
                              double (*positions_px)[2]);

/* The built-in eyes (surfaces) and instruments, by name; NULL-terminated lists. An unknown name is
 * PLACIDO_INPUT. Free a surface with placido_surface_free. */
const char *const *placido_phantom_eyes(void);
const char *const *placido_phantom_instruments(void);
int placido_phantom_eye(placido_surface **surface, const char *name, placido_error *err);
int placido_phantom_instrument(placido_instrument *instrument, const char *name,
                               placido_error *err);

/* Records a whole session (docs/formats.md) of `frame_count` frames, 1 to 100,000, at rate_hz, 0.1
 * to 10,000, of the eye `eye` ("OD" or "OS") in the directory `path`, which must not exist or be
 * empty. From frame to frame the eye drifts and trembles within 0.05 mm across and 0.012 mm along
 * the axis, and focus varies by a third of a pixel; one frame is out of focus (of two or more), one
 * has the lid half closed (of three), one is blurred by a jerk of the eye (of five). `disturbance`
 * (may be NULL) goes for every frame. The first frame is where `disturbance` puts the eye:
 * session.json's axis_z_mm is that frame's, its sigma 0.02 mm. truth-surface.json beside the frames
 * is the surface, without movement.
 * Returns PLACIDO_OK, PLACIDO_INPUT, PLACIDO_SYSTEM, PLACIDO_MEMORY, PLACIDO_UNSUPPORTED (no
 * sessions in this build). */
int placido_phantom_session(const char *path, const placido_surface *surface,
                            const placido_instrument *instrument, const char *eye,
                            int frame_count, double rate_hz,
                            const placido_disturbance *disturbance, int threads,
                            placido_error *err);

#endif
