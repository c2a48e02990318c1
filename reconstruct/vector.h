/* Loops over numbers that gain from wide vectors. */
#ifndef PLACIDO_RECONSTRUCT_VECTOR_H
#define PLACIDO_RECONSTRUCT_VECTOR_H

#include "base/dispatch.h"

#endif
