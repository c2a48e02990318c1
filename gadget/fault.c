/* The faults of a simulated camera by name. */
#include "gadget/picture.h"

#include <string.h>

static const char *const names[PLACIDO_GADGET_FAULTS] = {
    [PLACIDO_GADGET_FAULT_STALL] = "stall",
    [PLACIDO_GADGET_FAULT_DROP] = "drop",
    [PLACIDO_GADGET_FAULT_CORRUPT] = "corrupt",
    [PLACIDO_GADGET_FAULT_TRUNCATE] = "truncate",
    [PLACIDO_GADGET_FAULT_MISNUMBER] = "misnumber",
    [PLACIDO_GADGET_FAULT_LOST_START] = "lost-start",
    [PLACIDO_GADGET_FAULT_LOST_END] = "lost-end",
    [PLACIDO_GADGET_FAULT_PENDING] = "pending",
    [PLACIDO_GADGET_FAULT_SILENT] = "silent",
    [PLACIDO_GADGET_FAULT_REFUSE] = "refuse",
    [PLACIDO_GADGET_FAULT_GARBLE] = "garble",
};

int placido_gadget_fault_by_name(const char *name) {
  for (int i = 0; i < PLACIDO_GADGET_FAULTS; i++) {
    if (strcmp(names[i], name) == 0) {
      return i;
    }
  }
  return -1;
}

const char *placido_gadget_fault_name(enum placido_gadget_fault fault) {
  return names[fault];
}
