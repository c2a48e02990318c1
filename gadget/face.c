/* The table of faces. */
#include "gadget/face.h"

#include "gadget/u3v.h"
#include "gadget/uvc.h"

#include <string.h>

static const placido_gadget_face *const faces[] = {
    &placido_u3v_face,
    &placido_uvc_face,
};

const placido_gadget_face *const *placido_gadget_face_table(size_t *count) {
  *count = sizeof faces / sizeof faces[0];
  return faces;
}

const placido_gadget_face *placido_gadget_face_by_name(const char *name) {
  for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
    if (strcmp(faces[i]->name, name) == 0) {
      return faces[i];
    }
  }
  return NULL;
}
