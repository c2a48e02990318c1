/* What an eye with this cornea sees: rays through the surface to a planar retina, point spread
 * function, search of the correction, and scenes as the patient sees them. A library of its own:
 * surface in, pictures out. After D. Garcia, CWhatUC (Berkeley 2000). This header has all of it. */
#ifndef PLACIDO_SIMULATE_H
#define PLACIDO_SIMULATE_H

#include <placido/acuity.h>
#include <placido/convolution.h>
#include <placido/diffraction.h>
#include <placido/eye.h>
#include <placido/ghost.h>
#include <placido/plan.h>
#include <placido/psf.h>
#include <placido/quality.h>
#include <placido/scene.h>
#include <placido/wavefront.h>
#include <placido/zernike.h>

#endif
