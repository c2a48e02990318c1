/* A camera's node: found by path, serial number or place on the bus; opened, asked who it is, and
 * found again under another number. */
#include "drivers/v4l2/camera.h"

#include "base/text.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The kernel numbers nodes of one kind from 0 to 255. */
#define NODES_MAX 256

/* Text of a device: of bounded length, and fit for a line. */
static void copy_line(char *out, size_t size, const void *text) {
  const size_t length = strnlen(text, size - 1);
  memcpy(out, text, length);
  out[length] = '\0';
  placido_text_line(out);
}

/* The path of what the kernel tells of a node, as "index", or of the USB device that the node's
 * interface belongs to, as "device/../serial". Returns false where it is too long. */
static bool make_path(char path[1200], const placido_v4l2_calls *calls, const char *node,
                      const char *attribute) {
  const int length = snprintf(path, 1200, "%s/sys/class/video4linux/%s/%s", calls->root, node,
                              attribute);
  return length > 0 && length < 1200;
}

/* One attribute; left as it is where there is none. */
static void read_attribute(char *out, size_t size, const placido_v4l2_calls *calls,
                           const char *node, const char *attribute) {
  char path[1200], line[64] = "";
  FILE *file = make_path(path, calls, node, attribute) ? fopen(path, "re") : NULL;
  if (!file) {
    return;
  }
  if (fgets(line, sizeof line, file)) {
    line[strcspn(line, "\n")] = '\0';
    copy_line(out, size, line);
  }
  fclose(file);
}

static const char *node_of(const placido_v4l2_camera *camera) {
  const char *name = strrchr(camera->path, '/');
  return name ? name + 1 : camera->path;
}

/* QUERYCAP: who it is and whether it captures. Returns 0 or errno. */
static int identify(placido_v4l2_camera *camera) {
  struct v4l2_capability said = {0};
  const int code = placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_QUERYCAP, &said);
  if (code) {
    return code;
  }
  const uint32_t can =
      said.capabilities & V4L2_CAP_DEVICE_CAPS ? said.device_caps : said.capabilities;
  copy_line(camera->card, sizeof camera->card, said.card);
  copy_line(camera->driver, sizeof camera->driver, said.driver);
  copy_line(camera->bus, sizeof camera->bus, said.bus_info);
  const bool is_single = can & V4L2_CAP_VIDEO_CAPTURE;
  camera->is_multiplanar = !is_single && (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE);
  camera->type = camera->is_multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE
                                        : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  camera->can_stream = can & V4L2_CAP_STREAMING;
  camera->can_read = can & V4L2_CAP_READWRITE;
  return (is_single || camera->is_multiplanar) && (camera->can_stream || camera->can_read)
             ? 0
             : ENOTSUP;
}

/* Opens a node; returns 0 or errno, ENOTSUP where it is not a camera. */
static int open_node(placido_v4l2_camera *camera, const char *path,
                     const placido_v4l2_calls *calls) {
  *camera = (placido_v4l2_camera){.calls = calls, .fd = -1};
  const int length = snprintf(camera->path, sizeof camera->path, "%s", path);
  if (length < 0 || length >= (int)sizeof camera->path) {
    return ENAMETOOLONG;
  }
  for (int i = 0; i < 10 && camera->fd < 0; i++) {
    errno = 0;
    camera->fd = calls->open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (camera->fd < 0 && errno != EINTR) {
      return errno ? errno : EIO;
    }
  }
  const int code = camera->fd < 0 ? EINTR : identify(camera);
  if (code) {
    placido_v4l2_camera_close(camera);
    return code;
  }
  const char *node = node_of(camera);
  read_attribute(camera->vendor, sizeof camera->vendor, calls, node, "device/../manufacturer");
  read_attribute(camera->serial, sizeof camera->serial, calls, node, "device/../serial");
  read_attribute(camera->firmware, sizeof camera->firmware, calls, node, "device/../bcdDevice");
  read_attribute(camera->index, sizeof camera->index, calls, node, "index");
  return 0;
}

void placido_v4l2_camera_close(placido_v4l2_camera *camera) {
  if (camera->calls && camera->fd >= 0) {
    camera->calls->close(camera->fd);
  }
  camera->fd = -1;
}

bool placido_v4l2_camera_is_there(const placido_v4l2_camera *camera) {
  struct v4l2_capability said = {0};
  return camera->fd >= 0 &&
         placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_QUERYCAP, &said) == 0;
}

int placido_v4l2_camera_failed(const placido_v4l2_camera *camera, const char *action, int code,
                               placido_error *err) {
  const char *path = placido_text_tail(camera->path);
  if (!placido_v4l2_camera_is_there(camera)) {
    return placido_error_set(err, PLACIDO_GONE,
                             "the camera %s (%s) is gone: unplugged or without power",
                             camera->card, path);
  }
  return placido_error_set(err, PLACIDO_SYSTEM, "%s the camera %s (%s): %s", action, camera->card,
                           path,
                           code == EBUSY ? "another program uses it" : strerror(code));
}

/* The numbers of the nodes that the kernel lists, in `there`. A kernel without cameras has no such
 * directory. */
static void list_nodes(bool there[NODES_MAX], const placido_v4l2_calls *calls) {
  char path[1200];
  memset(there, 0, NODES_MAX * sizeof *there);
  const int length = snprintf(path, sizeof path, "%s/sys/class/video4linux", calls->root);
  DIR *directory = length < (int)sizeof path ? opendir(path) : NULL;
  const struct dirent *entry;
  while (directory && (entry = readdir(directory))) {
    const char *digits = entry->d_name + strlen("video");
    if (strncmp(entry->d_name, "video", strlen("video")) == 0 && *digits &&
        strspn(digits, "0123456789") == strlen(digits) && strlen(digits) <= 3 &&
        atoi(digits) < NODES_MAX) {
      there[atoi(digits)] = true;
    }
  }
  if (directory) {
    closedir(directory);
  }
}

int placido_v4l2_camera_each(const placido_v4l2_calls *calls,
                             int (*found)(void *user, placido_v4l2_camera *camera), void *user,
                             placido_error *err) {
  (void)err;
  bool there[NODES_MAX];
  list_nodes(there, calls);
  int status = PLACIDO_OK;
  for (int i = 0; !status && i < NODES_MAX; i++) {
    char path[1200];
    placido_v4l2_camera camera;
    snprintf(path, sizeof path, "%s/dev/video%d", calls->root, i);
    if (there[i] && open_node(&camera, path, calls) == 0) {
      status = found(user, &camera);
      placido_v4l2_camera_close(&camera);
    }
  }
  return status;
}

/* The search for one camera by what it says of itself. */
struct search {
  const char *serial, *bus; /* one of them is NULL */
  char path[1024];          /* of the first node that fits */
  char found_bus[33];
  bool is_ambiguous;
};

static int compare(void *user, placido_v4l2_camera *camera) {
  struct search *search = user;
  if (strcmp(search->serial ? search->serial : search->bus,
             search->serial ? camera->serial : camera->bus) != 0) {
    return 0;
  }
  if (!search->path[0]) {
    memcpy(search->path, camera->path, sizeof search->path);
    memcpy(search->found_bus, camera->bus, sizeof search->found_bus);
  } else if (strcmp(search->found_bus, camera->bus) != 0) {
    search->is_ambiguous = true; /* nodes of one camera share its place on the bus */
  }
  return 0;
}

/* The path that an address means, in search->path. */
static int resolve(struct search *search, const char *address, const placido_v4l2_calls *calls,
                   placido_error *err) {
  *search = (struct search){0};
  if (strncmp(address, "serial=", 7) == 0) {
    search->serial = address + 7;
  } else if (strncmp(address, "bus=", 4) == 0) {
    search->bus = address + 4;
  } else {
    const int length = snprintf(search->path, sizeof search->path, "%s%s", calls->root, address);
    return length > 0 && length < (int)sizeof search->path && address[0]
               ? PLACIDO_OK
               : placido_error_set(err, PLACIDO_INPUT,
                                   "\"v4l2:%.100s\" is not v4l2:/dev/videoN, v4l2:serial=TEXT or "
                                   "v4l2:bus=TEXT",
                                   address);
  }
  int status = placido_v4l2_camera_each(calls, compare, search, err);
  if (!status && !search->path[0]) {
    status = placido_error_set(err, PLACIDO_SYSTEM,
                               "no camera with %.100s is plugged in (placido devices lists them)",
                               address);
  }
  if (!status && search->is_ambiguous) {
    status = placido_error_set(err, PLACIDO_INPUT,
                               "several cameras have %.100s; name the one by its bus: v4l2:bus=%s",
                               address, search->found_bus);
  }
  return status;
}

/* A link (/dev/v4l/by-id/...) is followed once, so that the node's name can be told. */
static void follow_link(char path[1024]) {
  char *target = realpath(path, NULL);
  if (target && strlen(target) < 1024) {
    memcpy(path, target, strlen(target) + 1);
  }
  free(target);
}

static int cannot_open(const char *path, int code, placido_error *err) {
  path = placido_text_tail(path);
  if (code == ENOTSUP || code == ENOTTY) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s is not a camera: it gives no pictures",
                             path);
  }
  return placido_error_set(err, PLACIDO_SYSTEM, "cannot open %s: %s%s", path, strerror(code),
                           code == EACCES ? " (is the user in the group video?)" : "");
}

int placido_v4l2_camera_open(placido_v4l2_camera *camera, const char *address,
                             const placido_v4l2_calls *calls, placido_error *err) {
  *camera = (placido_v4l2_camera){.calls = calls, .fd = -1};
  struct search search;
  const int status = resolve(&search, address, calls, err);
  if (status) {
    return status;
  }
  follow_link(search.path);
  const int code = open_node(camera, search.path, calls);
  return code ? cannot_open(search.path, code, err) : PLACIDO_OK;
}

/* Whether the USB devices that two nodes belong to are one. */
static bool share_device(const placido_v4l2_calls *calls, const char *a, const char *b) {
  char path_a[1200], path_b[1200];
  struct stat of_a, of_b;
  return make_path(path_a, calls, a, "device/..") && make_path(path_b, calls, b, "device/..") &&
         stat(path_a, &of_a) == 0 && stat(path_b, &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

bool placido_v4l2_camera_has_twin(const placido_v4l2_camera *camera) {
  bool there[NODES_MAX], found = false;
  list_nodes(there, camera->calls);
  for (int i = 0; camera->serial[0] && !found && i < NODES_MAX; i++) {
    char node[16], serial[sizeof camera->serial] = "";
    snprintf(node, sizeof node, "video%d", i);
    if (there[i] && strcmp(node, node_of(camera)) != 0) {
      read_attribute(serial, sizeof serial, camera->calls, node, "device/../serial");
      found = strcmp(serial, camera->serial) == 0 &&
              !share_device(camera->calls, node, node_of(camera));
    }
  }
  return found;
}

/* The search for a camera that was unplugged. */
struct reunion {
  const placido_v4l2_camera *known;
  bool by_bus;
  char path[1024]; /* of the node that is it */
};

static bool is_it(const struct reunion *reunion, const placido_v4l2_camera *camera) {
  const placido_v4l2_camera *known = reunion->known;
  return strcmp(known->card, camera->card) == 0 && strcmp(known->serial, camera->serial) == 0 &&
         strcmp(known->index, camera->index) == 0 &&
         (!reunion->by_bus || strcmp(known->bus, camera->bus) == 0);
}

static int recognise(void *user, placido_v4l2_camera *camera) {
  struct reunion *reunion = user;
  if (!is_it(reunion, camera)) {
    return 0;
  }
  memcpy(reunion->path, camera->path, sizeof reunion->path);
  return 1;
}

/* Opens a node if it is the camera. Returns 0, errno, or ENODEV where it is another one, whose name
 * is then in `other`. */
static int open_known(placido_v4l2_camera *camera, const struct reunion *reunion,
                      const char *path, char other[33]) {
  const int code = open_node(camera, path, reunion->known->calls);
  if (!code && !is_it(reunion, camera)) {
    memcpy(other, camera->card, sizeof camera->card);
    placido_v4l2_camera_close(camera);
    return ENODEV;
  }
  return code;
}

int placido_v4l2_camera_find(placido_v4l2_camera *camera, const placido_v4l2_camera *known,
                             const char *address, bool has_twin, placido_error *err) {
  struct reunion reunion = {.known = known, .by_bus = has_twin || !known->serial[0]};
  char path[1024], other[33] = "";
  const int length = snprintf(path, sizeof path, "%s%s", known->calls->root, address);
  /* A path of the address first: it is likely, and the only way where there is no /sys. */
  int code = ENODEV;
  if (strchr(address, '/') && length > 0 && length < (int)sizeof path) {
    follow_link(path);
    code = open_known(camera, &reunion, path, other);
  }
  if (code && placido_v4l2_camera_each(known->calls, recognise, &reunion, NULL) == 1) {
    memcpy(path, reunion.path, sizeof path);
    code = open_known(camera, &reunion, path, other);
  }
  if (!code) {
    return PLACIDO_OK;
  }
  *camera = *known;
  camera->fd = -1;
  if (other[0]) {
    return placido_error_set(err, PLACIDO_GONE, "v4l2:%s is the camera %s now, not %s", address,
                             other, known->card);
  }
  return code == ENOENT || code == ENODEV || code == ENXIO
             ? placido_v4l2_camera_failed(camera, "finding", code, err)
             : cannot_open(path, code, err);
}
