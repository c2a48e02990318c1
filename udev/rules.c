/* What udev is told of the drivers' devices: each row of their tables as rules, so that permissions
 * and names can never speak of other devices than the drivers do. */
#include "udev/rules.h"

#include <stdbool.h>
#include <string.h>

#define WORD "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"
#define BY_SERIAL "$env{ID_SERIAL_SHORT}"
#define BY_PATH "$env{ID_PATH}"

static bool is_word(const char *text) {
  return text[0] && strspn(text, WORD "-") == strlen(text);
}

/* What a name is made of where a $ or % stands, in `part` (as "ENV{ID_PATH}"; empty for the
 * kernel's own name, which is always there). Returns its length, 0 where it is none we know. */
static size_t read_part(char part[80], const char *text) {
  static const struct {
    const char *begin, *key;
  } kinds[] = {{"$env{", "ENV"}, {"$attr{", "ATTR"}};
  part[0] = '\0';
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    const size_t begin = strlen(kinds[i].begin);
    const bool begins = strncmp(text, kinds[i].begin, begin) == 0;
    const size_t length = begins ? strspn(text + begin, WORD) : 0;
    if (length > 0 && length < 64 && text[begin + length] == '}') {
      snprintf(part, 80, "%s{%.*s}", kinds[i].key, (int)length, text + begin);
      return begin + length + 1;
    }
  }
  return strncmp(text, "%k", 2) == 0 ? 2 : 0;
}

static bool is_link(const char *link) {
  char part[80];
  const char *at = link;
  while (*at) {
    const size_t length = *at == '$' || *at == '%' ? read_part(part, at) : strspn(at, WORD "-.");
    if (length == 0) {
      return false;
    }
    at += length;
  }
  return at > link && link[0] != '.' && !strstr(link, "..");
}

static bool is_byte(int value) {
  return value >= -1 && value <= 0xff;
}

static int check_row(const placido_driver *driver, const placido_match *match,
                     placido_error *err) {
  const bool fits = is_word(match->subsystem) && is_byte(match->usb_class) &&
                    is_byte(match->usb_subclass) &&
                    (match->usb_class >= 0) == (strcmp(match->subsystem, "usb") == 0) &&
                    (!match->link || is_link(match->link)) &&
                    (!match->group || is_word(match->group)) &&
                    (!match->only || !strpbrk(match->only, "\n\\"));
  return fits ? PLACIDO_OK
              : placido_error_set(err, PLACIDO_INPUT,
                                  "the driver %s has a row for the subsystem \"%s\" (link \"%s\") "
                                  "that does not fit into udev's rules",
                                  driver->scheme, match->subsystem,
                                  match->link ? match->link : "");
}

/* Two hexadecimal digits, or what stands for any. */
static const char *digits(char text[3], int value, const char *format, const char *any) {
  snprintf(text, 3, value < 0 ? any : format, (unsigned)value);
  return text;
}

/* The conditions that a device must meet, each with a comma behind it. */
static void write_conditions(FILE *file, const placido_match *match) {
  char class[3], subclass[3];
  fprintf(file, "SUBSYSTEM==\"%s\", ", match->subsystem);
  if (match->usb_class >= 0) {
    fprintf(file, "ENV{DEVTYPE}==\"usb_device\", ENV{ID_USB_INTERFACES}==\"*:%s%s??:*\", ",
            digits(class, match->usb_class, "%02x", "??"),
            digits(subclass, match->usb_subclass, "%02x", "??"));
  }
  if (match->only) {
    fprintf(file, "%s, ", match->only);
  }
}

/* A name, for devices of which all is known that it is made of. */
static void write_link(FILE *file, const placido_match *match, const char *link) {
  write_conditions(file, match);
  for (const char *at = strpbrk(link, "$%"); at; at = strpbrk(at, "$%")) {
    char part[80];
    at += read_part(part, at);
    if (part[0]) {
      fprintf(file, "%s==\"?*\", ", part);
    }
  }
  fprintf(file, "SYMLINK+=\"placido/%s\"\n", link);
}

/* The same name by the place in which the device is plugged in: for those that have no serial
 * number, or share one. */
static void write_link_by_path(FILE *file, const placido_match *match) {
  const char *serial = strstr(match->link, BY_SERIAL);
  char link[300];
  if (serial && strlen(match->link) < sizeof link - sizeof BY_PATH) {
    snprintf(link, sizeof link, "%.*s%s%s", (int)(serial - match->link), match->link, BY_PATH,
             serial + strlen(BY_SERIAL));
    write_link(file, match, link);
  }
}

static void write_row(FILE *file, const placido_driver *driver, const placido_match *match) {
  fprintf(file, "\n# %s: %s\n", driver->scheme, driver->summary);
  write_conditions(file, match);
  fprintf(file, "TAG+=\"uaccess\", ENV{ID_PLACIDO_DRIVER}=\"%s\"", driver->scheme);
  if (match->group) {
    fprintf(file, ", GROUP=\"%s\"", match->group);
  }
  fputs("\n", file);
  if (match->link) {
    write_link(file, match, match->link);
    write_link_by_path(file, match);
  }
  if (match->usb_class >= 0) {
    fputs("ACTION==\"add\", ", file);
    write_conditions(file, match);
    fputs("TEST==\"power/control\", ATTR{power/control}=\"on\"\n", file);
  }
}

/* Whatever was written: whether it arrived. */
static int finish(FILE *file, placido_error *err) {
  return fflush(file) == 0 && !ferror(file)
             ? PLACIDO_OK
             : placido_error_set(err, PLACIDO_SYSTEM, "the text for udev cannot be written");
}

/* Calls `write` for every row of every driver. */
static int each_row(FILE *file, const placido_driver *const *drivers, size_t count,
                    void (*write)(FILE *file, const placido_driver *driver,
                                  const placido_match *match),
                    placido_error *err) {
  for (size_t i = 0; i < count; i++) {
    for (const placido_match *row = drivers[i]->matches; row && row->subsystem; row++) {
      const int status = check_row(drivers[i], row, err);
      if (status) {
        return status;
      }
      write(file, drivers[i], row);
    }
  }
  return finish(file, err);
}

int placido_udev_rules(FILE *file, const placido_driver *const *drivers, size_t count,
                       placido_error *err) {
  fputs("# Devices that Placido drives. Written from the drivers' tables when it was built.\n"
        "# The person at the seat may use them (uaccess; given by 73-seat-late.rules, behind this\n"
        "# file), and the group where one is named; nobody else.\n"
        "# A USB3 Vision camera stays awake, whatever a power saver has made the default: many\n"
        "# USB devices do not come back from a suspension (the kernel's\n"
        "# Documentation/driver-api/usb/power-management.rst, Warnings), and it has no kernel\n"
        "# driver that would know better.\n\n"
        "ACTION==\"remove\", GOTO=\"placido_end\"\n",
        file);
  const int status = each_row(file, drivers, count, write_row, err);
  fputs("\nLABEL=\"placido_end\"\n", file);
  return status ? status : finish(file, err);
}

static void write_hwdb_row(FILE *file, const placido_driver *driver, const placido_match *match) {
  char class[3], subclass[3];
  if (match->usb_class >= 0) {
    fprintf(file, "\n# %s\nusb:v*p*d*dc*dsc*dp*ic%sisc%sip*\n ID_PLACIDO_DRIVER=%s\n",
            driver->summary, digits(class, match->usb_class, "%02X", "*"),
            digits(subclass, match->usb_subclass, "%02X", "*"), driver->scheme);
  }
}

int placido_udev_hwdb(FILE *file, const placido_driver *const *drivers, size_t count,
                      placido_error *err) {
  fputs("# Interfaces of USB devices that Placido drives. Written from the drivers' tables when\n"
        "# it was built.\n",
        file);
  return each_row(file, drivers, count, write_hwdb_row, err);
}

static void write_group(FILE *file, const placido_driver *driver, const placido_match *match) {
  (void)driver;
  if (match->group) {
    fprintf(file, "g %s -\n", match->group);
  }
}

int placido_udev_groups(FILE *file, const placido_driver *const *drivers, size_t count,
                        placido_error *err) {
  fputs("# Groups that udev's rules for Placido name.\n", file);
  return each_row(file, drivers, count, write_group, err);
}
