/* Which USB devices are cameras: descriptors, as bytes from a stranger, to bounded structs.
 *
 * The descriptors of configuration and interfaces are the kernel's copies, so looking costs a
 * device that is no camera nothing, and asks it nothing. */
#include "drivers/u3v/usb.h"

#include <stdio.h>
#include <string.h>

/* USB3 Vision 1.0, section 3: classes of the interfaces, and the descriptor behind the first. */
#define CLASS_MISCELLANEOUS 0xEF
#define SUBCLASS_U3V 0x05
#define PROTOCOL_CONTROL 0x00
#define PROTOCOL_STREAM 0x02
#define DESCRIPTOR_INFO 0x24
#define DESCRIPTOR_INFO_SUBTYPE 0x01
#define INFO_BYTES 20

#define STRING_TIMEOUT_MS 300
#define PORTS_MAX 7 /* as deep as hubs go */

/* Bus and ports as the kernel writes them: 4-1.2. */
static bool find_place(char place[32], libusb_device *device) {
  uint8_t ports[PORTS_MAX];
  const int count = libusb_get_port_numbers(device, ports, PORTS_MAX);
  if (count < 1) {
    return false; /* a root hub */
  }
  int length = snprintf(place, 32, "%d", libusb_get_bus_number(device));
  for (int i = 0; i < count && length < 32; i++) {
    length += snprintf(place + length, (size_t)(32 - length), "%c%d", i ? '.' : '-', ports[i]);
  }
  return length < 32;
}

static int speed_mbit(libusb_device *device) {
  switch (libusb_get_device_speed(device)) {
  case LIBUSB_SPEED_FULL:
    return 12;
  case LIBUSB_SPEED_HIGH:
    return 480;
  case LIBUSB_SPEED_SUPER:
    return 5000;
  case LIBUSB_SPEED_SUPER_PLUS:
    return 10000;
  default:
    return 0;
  }
}

/* The first bulk endpoint of a direction; 0: there is none. */
static uint8_t find_bulk(const struct libusb_interface_descriptor *interface, uint8_t direction,
                         int *packet_bytes) {
  for (int i = 0; i < interface->bNumEndpoints; i++) {
    const struct libusb_endpoint_descriptor *endpoint = &interface->endpoint[i];
    const int bytes = endpoint->wMaxPacketSize & 0x7ff;
    if ((endpoint->bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK &&
        (endpoint->bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == direction && bytes >= 1 &&
        bytes <= 1024) {
      *packet_bytes = bytes;
      return endpoint->bEndpointAddress;
    }
  }
  return 0;
}

/* The class-specific descriptor that names the camera, among what stands behind an interface;
 * NULL: there is none. */
static const uint8_t *find_info(const struct libusb_interface_descriptor *interface) {
  const uint8_t *at = interface->extra;
  size_t left = interface->extra_length > 0 ? (size_t)interface->extra_length : 0;
  while (at && left >= 2 && at[0] >= 2 && at[0] <= left) {
    if (at[0] >= INFO_BYTES && at[1] == DESCRIPTOR_INFO && at[2] == DESCRIPTOR_INFO_SUBTYPE) {
      return at;
    }
    left -= at[0];
    at += at[0];
  }
  return NULL;
}

/* Looks for the two interfaces of a camera; `info` becomes its descriptor or stays. */
static bool find_interfaces(placido_u3v_found *found, const uint8_t **info,
                            const struct libusb_config_descriptor *config) {
  bool has_control = false, has_stream = false;
  for (int i = 0; i < config->bNumInterfaces; i++) {
    if (config->interface[i].num_altsetting < 1) {
      continue;
    }
    const struct libusb_interface_descriptor *interface = &config->interface[i].altsetting[0];
    if (interface->bInterfaceClass != CLASS_MISCELLANEOUS ||
        interface->bInterfaceSubClass != SUBCLASS_U3V) {
      continue;
    }
    int out_bytes;
    if (interface->bInterfaceProtocol == PROTOCOL_CONTROL && !has_control) {
      found->control_interface = interface->bInterfaceNumber;
      found->control_in =
          find_bulk(interface, LIBUSB_ENDPOINT_IN, &found->control_packet_bytes);
      found->control_out = find_bulk(interface, LIBUSB_ENDPOINT_OUT, &out_bytes);
      has_control = found->control_in && found->control_out;
      *info = find_info(interface);
    } else if (interface->bInterfaceProtocol == PROTOCOL_STREAM && !has_stream) {
      found->stream_interface = interface->bInterfaceNumber;
      found->stream_in = find_bulk(interface, LIBUSB_ENDPOINT_IN, &found->stream_packet_bytes);
      has_stream = found->stream_in != 0;
    }
  }
  return has_control && has_stream;
}

/* Text of a stranger: what is not printable becomes '_', and blanks at the end go. */
static void clean(char text[64]) {
  size_t length = strlen(text);
  while (length > 0 && (text[length - 1] == ' ' || text[length - 1] == '\n')) {
    text[--length] = '\0';
  }
  for (size_t i = 0; i < length; i++) {
    if (text[i] < ' ' || text[i] > '~') {
      text[i] = '_';
    }
  }
}

static int ask_string(libusb_device_handle *handle, uint8_t index, uint16_t language,
                      uint8_t bytes[255]) {
  const int size = libusb_control_transfer(
      handle, LIBUSB_ENDPOINT_IN, LIBUSB_REQUEST_GET_DESCRIPTOR,
      (uint16_t)(LIBUSB_DT_STRING << 8 | index), language, bytes, 255, STRING_TIMEOUT_MS);
  if (size < 0) {
    return size;
  }
  return size >= 2 && bytes[1] == LIBUSB_DT_STRING && bytes[0] < size ? bytes[0] : size;
}

/* One of the device's strings. False where the device does not answer, so that it is not asked
 * seven times in vain. */
static bool read_string(char text[64], libusb_device_handle *handle, uint8_t index,
                        uint16_t language) {
  uint8_t bytes[255];
  if (index == 0) {
    return true;
  }
  const int size = ask_string(handle, index, language, bytes);
  if (size < 2 || bytes[1] != LIBUSB_DT_STRING) {
    return size != LIBUSB_ERROR_TIMEOUT && size != LIBUSB_ERROR_NO_DEVICE;
  }
  int length = 0;
  for (int i = 2; i + 1 < size && length < 63 && (bytes[i] || bytes[i + 1]); i += 2) {
    text[length++] = bytes[i + 1] == 0 && bytes[i] < 0x7f ? (char)bytes[i] : '_';
  }
  text[length] = '\0';
  clean(text);
  return true;
}

/* The strings that the camera's own descriptor names, then those that every USB device has. */
static void read_strings(placido_u3v_found *found, libusb_device_handle *handle,
                         const struct libusb_device_descriptor *device, const uint8_t *info) {
  static const uint8_t none[INFO_BYTES] = {0};
  const uint8_t *index = info ? info : none;
  const struct {
    char *text;
    uint8_t index;
  } strings[] = {
      {found->guid, index[11]},
      {found->vendor, index[12] ? index[12] : device->iManufacturer},
      {found->model, index[13] ? index[13] : device->iProduct},
      {found->version, index[15]},
      {found->serial, index[17] ? index[17] : device->iSerialNumber},
      {found->user_name, index[18]},
  };
  uint8_t bytes[255];
  const int size = ask_string(handle, 0, 0, bytes);
  const uint16_t language =
      size >= 4 ? (uint16_t)(bytes[2] | (unsigned)bytes[3] << 8) : 0x0409 /* English */;
  bool answers = size != LIBUSB_ERROR_TIMEOUT && size != LIBUSB_ERROR_NO_DEVICE;
  for (size_t i = 0; answers && i < sizeof strings / sizeof *strings; i++) {
    answers = read_string(strings[i].text, handle, strings[i].index, language);
  }
}

/* What the kernel read when the device was plugged in; stays empty where it has no such file. */
static void read_kernel_string(char text[64], const char *place, const char *file) {
  char path[96];
  snprintf(path, sizeof path, "/sys/bus/usb/devices/%s/%s", place, file);
  FILE *stream = text[0] ? NULL : fopen(path, "re");
  if (stream) {
    if (!fgets(text, 64, stream)) {
      text[0] = '\0';
    }
    fclose(stream);
    clean(text);
  }
}

static bool describe(placido_u3v_found *found, libusb_device *device,
                     const struct libusb_device_descriptor *descriptor,
                     const struct libusb_config_descriptor *config) {
  const uint8_t *info = NULL;
  *found = (placido_u3v_found){.vendor_id = descriptor->idVendor,
                               .product_id = descriptor->idProduct,
                               .speed_mbit = speed_mbit(device)};
  if (!find_interfaces(found, &info, config) || !find_place(found->place, device)) {
    return false;
  }
  libusb_device_handle *handle;
  if (libusb_open(device, &handle) == 0) {
    read_strings(found, handle, descriptor, info);
    libusb_close(handle);
  }
  read_kernel_string(found->vendor, found->place, "manufacturer");
  read_kernel_string(found->model, found->place, "product");
  read_kernel_string(found->serial, found->place, "serial");
  return true;
}

/* Whether the device is a camera, and which. */
static bool is_camera(placido_u3v_found *found, libusb_device *device) {
  struct libusb_device_descriptor descriptor;
  struct libusb_config_descriptor *config;
  if (libusb_get_device_descriptor(device, &descriptor) ||
      descriptor.bDeviceClass == LIBUSB_CLASS_HUB ||
      libusb_get_active_config_descriptor(device, &config)) {
    return false;
  }
  const bool is = describe(found, device, &descriptor, config);
  libusb_free_config_descriptor(config);
  return is;
}

int placido_u3v_usb_each(void *context,
                         int (*found)(void *user, const placido_u3v_found *device), void *user,
                         placido_error *err) {
  (void)context;
  libusb_context *usb;
  const int code = libusb_init(&usb);
  if (code) {
    return code == LIBUSB_ERROR_NO_MEM
               ? placido_error_set(err, PLACIDO_MEMORY, "no memory for the list of USB devices")
               : PLACIDO_OK;
  }
  libusb_device **devices;
  const ssize_t count = libusb_get_device_list(usb, &devices);
  int status = PLACIDO_OK;
  for (ssize_t i = 0; !status && i < count; i++) {
    placido_u3v_found device;
    if (is_camera(&device, devices[i])) {
      status = found(user, &device);
    }
  }
  if (count >= 0) {
    libusb_free_device_list(devices, 1);
  }
  libusb_exit(usb);
  return status;
}

libusb_device *placido_u3v_usb_at(libusb_context *usb, const char *place) {
  libusb_device **devices, *at = NULL;
  const ssize_t count = libusb_get_device_list(usb, &devices);
  for (ssize_t i = 0; !at && i < count; i++) {
    char here[32];
    if (find_place(here, devices[i]) && strcmp(here, place) == 0) {
      at = libusb_ref_device(devices[i]);
    }
  }
  if (count >= 0) {
    libusb_free_device_list(devices, 1);
  }
  return at;
}
