/* SPDX-License-Identifier: MIT
 *
 * suture/device.h - the binary contract between `suture live` and a thing in a hand: a mouse with
 * six axes, an arm that pushes back, a program that stands in for either.
 *
 * A device is a shared library that exports one function, suture_device_v1(). `suture live SCENE
 * --device NAME:ARGUMENT` loads NAME.so from the folder `devices` of each folder that is searched
 * for plugins (docs/sdk.md), or the file NAME itself if it ends in ".so":
 *
 *   cc -shared -fPIC -O2 -o NAME.so name.c       into ~/.local/share/suture/plugins/devices/
 *
 * A whole device is about 30 lines; plugins/devices/poses.c in the sources of Suture is an example.
 *
 * Calls. All functions of a device are called on one thread of its own, never at the same time:
 *
 *   open   ( read  write ) ( read  write ) ...   close
 *            `---- 1 ms --´
 *
 * read and write should return within 0.1 ms and must not wait: a call that takes longer delays
 * the next ones, but never the run. No exception crosses the boundary. The library stays loaded
 * until the program ends. Arrays and texts that are passed in belong to the host and are valid
 * during the call.
 */
#ifndef SUTURE_DEVICE_H
#define SUTURE_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SUTURE_DEVICE_VERSION 1u /* of this contract; must be equal in device and host */
#define SUTURE_DEVICE_SYMBOL "suture_device_v1"

/* Where the hand is, in axes parallel to those of the scene. What it holds in the run follows its
 * motion from the moment at which the run begins to play; so the origin is the device's choice. */
typedef struct suture_device_pose {
  double position[3]; /* m */
  double rotation[3]; /* rad: turns by the vector's length about its direction */
  uint32_t buttons;   /* bit i: button i is down */
  uint32_t reserved;  /* 0 */
} suture_device_pose;

/* What the hand is to feel. It is not limited: a device gives as much of it as it safely can. */
typedef struct suture_device_force {
  double force[3];  /* N, on the hand */
  double torque[3]; /* N m, about the centre of what it holds */
} suture_device_force;

/* Returned by read. Any other value counts as SUTURE_DEVICE_ENDED. */
#define SUTURE_DEVICE_SAME 0     /* the hand has not moved; `pose` was not written */
#define SUTURE_DEVICE_NEW 1      /* `pose` was written; numbers that are not finite are ignored */
#define SUTURE_DEVICE_ENDED (-1) /* nothing more will come, for the reason in `why` */

/* `why`, where a function has it: room for a text of up to `why_size` bytes with its final zero. It
 * is empty before the call, and shown to the user after the name of the device. */
typedef struct suture_device {
  uint32_t size;    /* sizeof(suture_device); a later minor revision may append members */
  uint32_t version; /* SUTURE_DEVICE_VERSION */
  const char* name; /* in recordings: "spacemouse" */
  const char* doc;  /* one sentence, and what the argument means */
  /* Returns a handle, or NULL and the reason in `why`. `argument` is what followed "NAME:", or "".
   * It may wait for the device. */
  void* (*open)(const char* argument, char* why, size_t why_size);
  /* Called 1000 times per second. `pose` holds the last pose when it is called, zeros at first. */
  int32_t (*read)(void* handle, suture_device_pose* pose, char* why, size_t why_size);
  /* Called after each read that did not return SUTURE_DEVICE_ENDED. NULL: takes no force. */
  void (*write)(void* handle, const suture_device_force* force);
  void (*close)(void* handle); /* once for each handle */
} suture_device;

/* What a device exports. The table is constant and lives as long as the library. */
typedef const suture_device* (*suture_device_function)(void);

#ifdef __cplusplus
}
#endif
#endif
