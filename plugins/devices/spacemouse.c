/* SPDX-License-Identifier: MIT
 *
 * A mouse with six axes, through the daemon spacenavd, which sends deflections. This device sums
 * them up to a pose (turns as vectors, which is exact about one axis); it takes no force. The axes
 * are those of spacenavd, see its configuration. */
#define _POSIX_C_SOURCE 200809L
#include <spnav.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#include "suture/device.h"

/* At full deflection, which is about 350. */
static const double full = 350, usual_speed = 0.05 /* m/s */, spin_per_speed = 20 /* rad/m */;

typedef struct {
  double speed; /* m/s */
  int way[3], turn[3];
  uint32_t buttons;
  suture_device_pose pose;
  struct timespec last;
} mouse;

static void* open_mouse(const char* argument, char* why, size_t why_size) {
  char* end = NULL;
  const double speed = *argument == '\0' ? usual_speed : strtod(argument, &end);
  if ((end != NULL && *end != '\0') || !(speed > 0 && speed < 1e3)) {
    snprintf(why, why_size,
             "'%s' is not a speed at full deflection in m/s, such as spacemouse:0.05", argument);
    return NULL;
  }
  if (spnav_open() < 0) {
    snprintf(why, why_size,
             "spacenavd does not answer; install and start it (apt-get install spacenavd)");
    return NULL;
  }
  mouse* self = calloc(1, sizeof *self);
  if (self == NULL) {
    snprintf(why, why_size, "out of memory");
    spnav_close();
    return NULL;
  }
  self->speed = speed;
  clock_gettime(CLOCK_MONOTONIC, &self->last);
  return self;
}

static double time_step(mouse* self) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  const double seconds =
      (double)(now.tv_sec - self->last.tv_sec) + 1e-9 * (double)(now.tv_nsec - self->last.tv_nsec);
  self->last = now;
  return seconds;
}

static void take(mouse* self, const spnav_event* event) {
  if (event->type == SPNAV_EVENT_MOTION) {
    const struct spnav_event_motion* m = &event->motion;
    const int way[] = {m->x, m->y, m->z}, turn[] = {m->rx, m->ry, m->rz};
    memcpy(self->way, way, sizeof way);
    memcpy(self->turn, turn, sizeof turn);
  } else if (event->type == SPNAV_EVENT_BUTTON && event->button.bnum >= 0 &&
             event->button.bnum < 32) {
    const uint32_t bit = 1u << event->button.bnum;
    self->buttons = event->button.press ? self->buttons | bit : self->buttons & ~bit;
  }
}

/* spnav_poll_event does not tell silence from a daemon that has gone. */
static int has_gone(void) {
  char byte;
  return recv(spnav_fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

static int32_t read_mouse(void* handle, suture_device_pose* pose, char* why, size_t why_size) {
  mouse* self = handle;
  spnav_event event;
  while (spnav_poll_event(&event) != 0) take(self, &event);
  if (has_gone()) {
    snprintf(why, why_size, "spacenavd has ended the connection");
    return SUTURE_DEVICE_ENDED;
  }
  const double way = self->speed / full * time_step(self);
  for (int c = 0; c < 3; ++c) {
    self->pose.position[c] += way * self->way[c];
    self->pose.rotation[c] += spin_per_speed * way * self->turn[c];
  }
  self->pose.buttons = self->buttons;
  if (memcmp(pose, &self->pose, sizeof *pose) == 0) return SUTURE_DEVICE_SAME;
  *pose = self->pose;
  return SUTURE_DEVICE_NEW;
}

static void close_mouse(void* handle) {
  spnav_close();
  free(handle);
}

__attribute__((visibility("default"))) const suture_device* suture_device_v1(void) {
  static const suture_device device = {
      sizeof(suture_device),
      SUTURE_DEVICE_VERSION,
      "spacemouse",
      "A mouse with six axes (spacenavd). Argument: its speed at full deflection, m/s.",
      open_mouse,
      read_mouse,
      NULL,
      close_mouse};
  return &device;
}
