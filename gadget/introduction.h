/* What passes between a simulated device and a host before the host has it. */
#ifndef PLACIDO_GADGET_INTRODUCTION_H
#define PLACIDO_GADGET_INTRODUCTION_H

#include "gadget/function.h"
#include "gadget/usbip.h"
#include "gadget/wire.h"

#define PLACIDO_GADGET_BUS_ID "1-1" /* what `usbip attach -b` asks for */

/* Answers a greeting: with the list, of one device and its interfaces, or with the device that was
 * asked for. Returns PLACIDO_OK, PLACIDO_INPUT (the gadget has no descriptors), PLACIDO_MEMORY. */
int placido_gadget_introduce(placido_gadget_wire *wire, placido_gadget *gadget,
                             enum placido_usbip_greeting greeting, placido_error *err);
/* Answers that there is no such device. */
int placido_gadget_turn_away(placido_gadget_wire *wire, placido_error *err);

#endif
