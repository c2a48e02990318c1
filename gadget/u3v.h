/* The simulated USB3 Vision camera. */
#ifndef PLACIDO_GADGET_U3V_H
#define PLACIDO_GADGET_U3V_H

#include "gadget/face.h"

extern const placido_gadget_face placido_u3v_face;

#endif
