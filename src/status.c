/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/status.h"
#include <stdarg.h>
#include <stdio.h>

const char *status_str(enum status status)
{
	switch (status) {
	case STATUS_OK:
		return "success";
	case STATUS_DOMAIN:
		return "argument out of range";
	case STATUS_NO_MEMORY:
		return "out of memory";
	case STATUS_IO:
		return "input or output failed";
	case STATUS_FORMAT:
		return "not a valid file of this kind";
	case STATUS_NO_DATA:
		return "no usable data";
	case STATUS_UNSUPPORTED:
		return "not supported";
	case STATUS_INTERRUPTED:
		return "interrupted";
	}
	return "unknown status";
}

enum status error_set(struct error *error, enum status status, const char *format, ...)
{
	if (error) {
		va_list args;
		va_start(args, format);
		const int length = vsnprintf(error->text, sizeof(error->text), format, args);
		va_end(args);
		if (length < 0)
			error->text[0] = '\0';
	}
	return status;
}
