/* What the camera played from a script says of itself: its registers and its description. */
#include "tests/drivers/u3v_fake.h"

#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/registers.h"

#include <stdio.h>
#include <string.h>

#define SBRM 0x10000u
#define MANIFEST 0x12000u
#define XML 0x13000u

static const char head[] =
    "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
    "<RegisterDescription ModelName=\"Fake\" VendorName=\"Test\" "
    "SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" SchemaSubMinorVersion=\"0\" "
    "xmlns=\"http://www.genicam.org/GenApi/Version_1_1\">\n"
    "<Category Name=\"Root\"><pFeature>Width</pFeature></Category>\n"
    "<Port Name=\"Device\"/>\n";

#define REGISTER(name, kind, address, access)                                     \
  "<" kind " Name=\"" name "\"><Address>" address                                 \
  "</Address><Length>4</Length><AccessMode>" access                               \
  "</AccessMode><pPort>Device</pPort><Cachable>NoCache</Cachable>"                \
  "<Endianess>LittleEndian</Endianess></" kind ">"
#define COMMAND(name, address)                                                    \
  "<Command Name=\"" name "\"><pValue>" name "Reg</pValue>"                       \
  "<CommandValue>1</CommandValue></Command>"                                      \
  REGISTER(name "Reg", "IntReg", address, "RW")
#define INTEGER(name, address, min, max, step)                                    \
  "<Integer Name=\"" name "\"><pValue>" name "Reg</pValue>" min max               \
  "<Inc>" step "</Inc></Integer>" REGISTER(name "Reg", "IntReg", address, "RW")
#define FLOAT(name, address, access, unit, min, max)                              \
  "<Float Name=\"" name "\"><pValue>" name "Reg</pValue><Min>" min "</Min><Max>"  \
  max "</Max><Unit>" unit "</Unit></Float>"                                       \
  REGISTER(name "Reg", "FloatReg", address, access)
#define ENTRY(name, value) \
  "<EnumEntry Name=\"" name "\"><Value>" value "</Value></EnumEntry>"
#define ENUMERATION(name, address, entries)                                       \
  "<Enumeration Name=\"" name "\">" entries "<pValue>" name "Reg</pValue>"        \
  "</Enumeration>" REGISTER(name "Reg", "IntReg", address, "RW")

/* Each feature by itself, so that a camera can lack it. */
static const struct {
  const char *name, *xml;
} features[] = {
    {"Width", INTEGER("Width", "0x40000", "<Min>8</Min>", "<pMax>WidthRoom</pMax>", "8")
              "<IntSwissKnife Name=\"WidthRoom\"><pVariable Name=\"O\">OffsetX</pVariable>"
              "<Formula>2048 - O</Formula></IntSwissKnife>"},
    {"Height", INTEGER("Height", "0x40004", "<Min>4</Min>", "<Max>1536</Max>", "2")},
    {"OffsetX", INTEGER("OffsetX", "0x40008", "<Min>0</Min>", "<pMax>OffsetRoom</pMax>", "8")
                "<IntSwissKnife Name=\"OffsetRoom\"><pVariable Name=\"W\">Width</pVariable>"
                "<Formula>2048 - W</Formula></IntSwissKnife>"},
    {"OffsetY", INTEGER("OffsetY", "0x4000c", "<Min>0</Min>", "<pMax>OffsetRoomY</pMax>", "2")
                "<IntSwissKnife Name=\"OffsetRoomY\"><pVariable Name=\"H\">Height</pVariable>"
                "<Formula>1536 - H</Formula></IntSwissKnife>"},
    {"PixelFormat", ENUMERATION("PixelFormat", "0x40010",
                                ENTRY("Mono8", "0x01080001") ENTRY("Mono12", "0x01100005")
                                ENTRY("Mono12p", "0x010C0047") ENTRY("Vendor7", "0x81080007"))},
    {"AcquisitionMode", ENUMERATION("AcquisitionMode", "0x40014",
                                    ENTRY("Continuous", "0") ENTRY("SingleFrame", "1"))},
    {"AcquisitionStart", COMMAND("AcquisitionStart", "0x40018")},
    {"AcquisitionStop", COMMAND("AcquisitionStop", "0x4001c")},
    {"ExposureAuto", ENUMERATION("ExposureAuto", "0x40020",
                                 ENTRY("Off", "0") ENTRY("Continuous", "2"))},
    {"ExposureTime", FLOAT("ExposureTime", "0x40024", "RW", "ms", "0.01", "9")},
    {"ExposureTimeRaw",
     INTEGER("ExposureTimeRaw", "0x4004c", "<Min>1</Min>", "<Max>4095</Max>", "1")},
    {"GainRaw", INTEGER("GainRaw", "0x40050", "<Min>0</Min>", "<Max>63</Max>", "1")},
    {"Gain", FLOAT("Gain", "0x40028", "RW", "dB", "0", "24")},
    {"AcquisitionFrameRateEnable",
     "<Boolean Name=\"AcquisitionFrameRateEnable\"><pValue>RateEnableReg</pValue>"
     "<OnValue>1</OnValue><OffValue>0</OffValue></Boolean>"
     REGISTER("RateEnableReg", "IntReg", "0x4002c", "RW")},
    {"AcquisitionFrameRateAbs",
     FLOAT("AcquisitionFrameRateAbs", "0x40030", "RW", "Hz", "1", "100")},
    {"TriggerMode", ENUMERATION("TriggerMode", "0x40034", ENTRY("Off", "0") ENTRY("On", "1"))},
    {"TriggerSource", ENUMERATION("TriggerSource", "0x40038",
                                  ENTRY("Line1", "1") ENTRY("Software", "7"))},
    {"TriggerSoftware", COMMAND("TriggerSoftware", "0x4003c")},
    {"DeviceTemperature", FLOAT("DeviceTemperature", "0x40040", "RO", "C", "-40", "120")},
    {"TLParamsLocked", INTEGER("TLParamsLocked", "0x40044", "<Min>0</Min>", "<Max>1</Max>", "1")},
    {"BlackLevelRaw", INTEGER("BlackLevelRaw", "0x40048", "<Min>0</Min>", "<Max>255</Max>", "5")},
};

/* Writes the description into the camera's memory, without what the test wants left out. */
void fake_describe(void) {
  char *text = (char *)fake.memory + XML;
  size_t length = (size_t)sprintf(text, "%s", head);
  for (size_t i = 0; i < sizeof features / sizeof *features; i++) {
    if ((!fake.without || !strstr(features[i].name, fake.without)) &&
        (!fake.without_exactly || strcmp(features[i].name, fake.without_exactly) != 0)) {
      length += (size_t)sprintf(text + length, "%s\n", features[i].xml);
    }
  }
  length += (size_t)sprintf(text + length, "</RegisterDescription>");
  placido_write_u64(fake.memory + MANIFEST + 8 + PLACIDO_MANIFEST_SIZE, length);
}

uint32_t fake_get(uint32_t address) {
  return placido_read_u32(fake.memory + address);
}

void fake_put(uint32_t address, uint32_t value) {
  placido_write_u32(fake.memory + address, value);
}

float fake_get_float(uint32_t address) {
  const uint32_t bits = fake_get(address);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

void fake_put_float(uint32_t address, float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  fake_put(address, bits);
}

const placido_pixel_format *fake_format(void) {
  const placido_pixel_format *format = placido_pixel_by_code(fake_get(FAKE_PIXEL_FORMAT));
  return format ? format : placido_pixel_by_name("Mono8");
}

size_t fake_picture_bytes(void) {
  return placido_pixel_row_bytes(fake_format(), (int)fake_get(FAKE_WIDTH)) * fake_get(FAKE_HEIGHT);
}

void fake_power_on(void) {
  fake_put(PLACIDO_ABRM_MAX_RESPONSE_MS, 200);
  strcpy((char *)fake.memory + PLACIDO_ABRM_MANUFACTURER, "Test");
  strcpy((char *)fake.memory + PLACIDO_ABRM_MODEL, "Fake");
  strcpy((char *)fake.memory + PLACIDO_ABRM_DEVICE_VERSION, "1.0");
  strcpy((char *)fake.memory + PLACIDO_ABRM_SERIAL, "S1");
  placido_write_u64(fake.memory + PLACIDO_ABRM_MANIFEST_ADDRESS, MANIFEST);
  placido_write_u64(fake.memory + PLACIDO_ABRM_SBRM_ADDRESS, SBRM);
  placido_write_u64(fake.memory + PLACIDO_ABRM_TIMESTAMP_INCREMENT, 1000);
  placido_write_u64(fake.memory + SBRM + PLACIDO_SBRM_CAPABILITY, 1);
  fake_put(SBRM + PLACIDO_SBRM_MAX_COMMAND, 128);
  fake_put(SBRM + PLACIDO_SBRM_MAX_ACK, 2048);
  fake_put(SBRM + PLACIDO_SBRM_STREAM_CHANNELS, 1);
  placido_write_u64(fake.memory + SBRM + PLACIDO_SBRM_SIRM_ADDRESS, FAKE_SIRM);
  fake_put(SBRM + PLACIDO_SBRM_SIRM_LENGTH, PLACIDO_SIRM_BYTES);
  placido_write_u64(fake.memory + MANIFEST, 1);
  fake_put(MANIFEST + 8, 0x01010000);
  placido_write_u64(fake.memory + MANIFEST + 8 + PLACIDO_MANIFEST_ADDRESS, XML);
  memset(fake.memory + FAKE_SIRM, 0, PLACIDO_SIRM_BYTES);
  fake_put(FAKE_SIRM + PLACIDO_SIRM_INFO, 3u << 24);
  fake_put(FAKE_SIRM + PLACIDO_SIRM_REQUIRED_LEADER, PLACIDO_U3V_LEADER_BYTES);
  fake_put(FAKE_SIRM + PLACIDO_SIRM_REQUIRED_TRAILER, PLACIDO_U3V_TRAILER_BYTES);
  memset(fake.memory + FAKE_WIDTH, 0, 0x100);
  fake_put(FAKE_WIDTH, 64);
  fake_put(FAKE_HEIGHT, 48);
  fake_put(FAKE_PIXEL_FORMAT, 0x01080001);
  fake_put_float(FAKE_EXPOSURE, 5);
  fake_put(FAKE_EXPOSURE_AUTO, 2);
  fake_put_float(FAKE_RATE, 100);
  fake_put_float(FAKE_TEMPERATURE, 41.5f);
  fake_put(FAKE_TRIGGER_SOURCE, 1);
}
