/* What the phantom draws random numbers for (base/random.h); keeps the sequences apart. */
#ifndef PLACIDO_PHANTOM_STREAMS_H
#define PLACIDO_PHANTOM_STREAMS_H

enum placido_phantom_stream {
  PLACIDO_PHANTOM_LASHES = 1,
  PLACIDO_PHANTOM_FILM,
  PLACIDO_PHANTOM_MOVEMENT,
  PLACIDO_PHANTOM_NOISE = 1000, /* plus the number of the frame */
};

#endif
