/* The drivers of this build, and the devices that they can see now. */
#include "drivers/driver.h"

#include <placido/device.h>

#include <string.h>

/* Who looks for devices, and what he made of the last one found. */
struct search {
  int (*found)(void *user, const char *uri, const char *description);
  void *user;
  int said; /* not 0: stop */
};

static int tell(void *user, const char *uri, const char *description) {
  struct search *search = user;
  search->said = search->found(search->user, uri, description);
  return search->said;
}

int placido_device_scan(const char *scheme,
                        int (*found)(void *user, const char *uri, const char *description),
                        void *user, placido_error *err) {
  size_t count;
  const placido_driver *const *drivers = placido_driver_table(&count);
  struct search search = {.found = found, .user = user};
  int first = PLACIDO_OK;
  bool is_known = false;
  for (size_t i = 0; !search.said && i < count; i++) {
    if (scheme && strcmp(drivers[i]->scheme, scheme) != 0) {
      continue;
    }
    is_known = true;
    if (drivers[i]->scan) {
      const int status = drivers[i]->scan(tell, &search, first ? NULL : err);
      first = first ? first : status;
    }
  }
  if (scheme && !is_known) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "no driver \"%.32s\" in this build",
                             scheme);
  }
  return search.said ? search.said : first;
}

void placido_driver_list(void (*each)(void *user, const char *scheme, const char *summary),
                         void *user) {
  size_t count;
  const placido_driver *const *drivers = placido_driver_table(&count);
  for (size_t i = 0; i < count; i++) {
    each(user, drivers[i]->scheme, drivers[i]->summary);
  }
}
