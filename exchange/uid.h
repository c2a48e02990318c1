/* DICOM's unique identifiers: "2.25." and a UUID as a decimal number (PS3.5, B.2; ISO 9834-8). */
#ifndef PLACIDO_EXCHANGE_UID_H
#define PLACIDO_EXCHANGE_UID_H

#include <placido/status.h>

#define PLACIDO_UID_SIZE 65

/* Identifier number `which` of `seed`: the same text and number, the same identifier. NULL: by
 * chance. PLACIDO_SYSTEM where the system has no random numbers. */
int placido_uid_make(char uid[PLACIDO_UID_SIZE], const char *seed, unsigned which,
                     placido_error *err);

#endif
