/* The description of the camera's features, gadget/camera.xml, built into the program. */
#ifndef PLACIDO_GADGET_U3V_XML_H
#define PLACIDO_GADGET_U3V_XML_H

#include <stddef.h>
#include <stdint.h>

extern const uint8_t placido_u3v_xml[];
extern const size_t placido_u3v_xml_bytes;

#endif
