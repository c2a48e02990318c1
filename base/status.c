/* The note that says why a function failed. */
#include <placido/status.h>

#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>

int placido_error_set(placido_error *err, int status, const char *format, ...) {
  if (!err) {
    return status;
  }
  va_list arguments;
  va_start(arguments, format);
  err->status = status;
  err->text[0] = '\0';
  vsnprintf(err->text, sizeof err->text, format, arguments);
  va_end(arguments);
  placido_text_line(err->text);
  return status;
}
