/* SPDX-License-Identifier: GPL-3.0-or-later
 * Devices that are wrong, one for each value of FAULT. */
#include <stdio.h>
#include <time.h>

#include "suture/device.h"

enum { no_symbol = 1, other_version, short_table, incomplete, closed, quiet, hanging, wild };

static void* open_device(const char* argument, char* why, size_t why_size) {
  static int handle;
  if (FAULT != closed) return &handle;
  snprintf(why, why_size, "'%s' is out of reach", argument);
  return NULL;
}

static int32_t read_device(void* handle, suture_device_pose* pose, char* why, size_t why_size) {
  (void)handle;
  if (FAULT == quiet) {
    snprintf(why, why_size, "the cable is gone");
    return SUTURE_DEVICE_ENDED;
  }
  if (FAULT == hanging) nanosleep(&(struct timespec){.tv_sec = 2}, NULL);
  const double nothing = 0;
  pose->position[0] = FAULT == wild ? 0 / nothing : 0;
  return FAULT == wild ? SUTURE_DEVICE_NEW : SUTURE_DEVICE_SAME;
}

static void close_device(void* handle) { (void)handle; }

const suture_device* DEVICE_FUNCTION(void);
const suture_device* DEVICE_FUNCTION(void) {
  static const suture_device device = {FAULT == short_table ? 16 : sizeof(suture_device),
                                       FAULT == other_version ? 7 : SUTURE_DEVICE_VERSION,
                                       "bad",
                                       "A device with a fault.",
                                       open_device,
                                       FAULT == incomplete ? NULL : read_device,
                                       NULL,
                                       close_device};
  return &device;
}
