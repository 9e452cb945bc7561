/* SPDX-License-Identifier: MIT
 *
 * Poses from a file, a pipe or a socket: for tests, and for programs that stand in for a hand.
 *
 * Each line is `seconds x y z rx ry rz buttons` in the units of suture/device.h; what is missing at
 * its end is 0, and # begins a comment. The hand is there from that time on, counted from the
 * opening of the device; a line whose time has passed counts at once. Through a socket (of the
 * kind `nc -lU PATH` makes) forces come back: lines `fx fy fz tx ty tz`, N and N m. */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "suture/device.h"

enum { text_size = 4096 };

typedef struct {
  double seconds;
  suture_device_pose pose;
} timed_pose;

typedef struct {
  int file, is_socket, has_next;
  struct timespec start;
  char text[text_size]; /* read, but not yet parsed */
  size_t size;
  unsigned long line;
  timed_pose next;
  char end[100]; /* why nothing more comes */
} poses;

static int open_socket(const char* path) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  const size_t length = strlen(path);
  const int file = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (length < sizeof address.sun_path) {
    memcpy(address.sun_path, path, length);
    if (file >= 0 && connect(file, (struct sockaddr*)&address, sizeof address) == 0) return file;
  } else {
    errno = ENAMETOOLONG;
  }
  const int problem = errno;
  if (file >= 0) close(file);
  errno = problem;
  return -1;
}

static void* open_poses(const char* path, char* why, size_t why_size) {
  if (*path == '\0') {
    snprintf(why, why_size, "it needs the path of a file or socket of poses: poses:PATH");
    return NULL;
  }
  int is_socket = 0;
  int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0 && errno == ENXIO) {
    is_socket = 1;
    file = open_socket(path);
  }
  poses* self = file < 0 ? NULL : calloc(1, sizeof *self);
  if (self == NULL) {
    snprintf(why, why_size, "cannot open %s: %s", path, strerror(errno));
    if (file >= 0) close(file);
    return NULL;
  }
  self->file = file;
  self->is_socket = is_socket;
  clock_gettime(CLOCK_MONOTONIC, &self->start);
  return self;
}

static double seconds_since(const struct timespec* start) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)(now.tv_sec - start->tv_sec) + 1e-9 * (double)(now.tv_nsec - start->tv_nsec);
}

/* The line without its end. 1: a pose, 0: blank, -1: neither. */
static int parse(const char* text, timed_pose* out) {
  double numbers[8] = {0};
  int count = 0;
  for (;; ++count) {
    text += strspn(text, " \t\r,");
    if (*text == '\0' || *text == '#') break;
    char* end = NULL;
    const double number = strtod(text, &end);
    if (end == text || count == 8) return -1;
    numbers[count] = number;
    text = end;
  }
  if (count == 0) return 0;
  if (count < 4 || !(numbers[7] >= 0 && numbers[7] <= UINT32_MAX)) return -1;
  out->seconds = numbers[0];
  memcpy(out->pose.position, numbers + 1, sizeof out->pose.position);
  memcpy(out->pose.rotation, numbers + 4, sizeof out->pose.rotation);
  out->pose.buttons = (uint32_t)numbers[7];
  return 1;
}

/* Whether `next` is there, filling it if a whole line is. At the end or a mistake, fills `end`. */
static int find_next(poses* self) {
  while (!self->has_next && *self->end == '\0') {
    char* end = memchr(self->text, '\n', self->size);
    if (end == NULL) {
      const ssize_t got = self->size == text_size
                              ? 0
                              : read(self->file, self->text + self->size, text_size - self->size);
      if (got < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
      if (got <= 0) {
        if (self->size == text_size)
          snprintf(self->end, sizeof self->end, "line %lu is longer than %d bytes", self->line + 1,
                   text_size);
        else
          snprintf(self->end, sizeof self->end, "its poses ended after %lu lines", self->line);
        return 0;
      }
      self->size += (size_t)got;
      continue;
    }
    *end = '\0';
    ++self->line;
    const int kind = parse(self->text, &self->next);
    self->size -= (size_t)(end + 1 - self->text);
    memmove(self->text, end + 1, self->size);
    self->has_next = kind > 0;
    if (kind < 0)
      snprintf(self->end, sizeof self->end, "line %lu is not 'seconds x y z rx ry rz buttons'",
               self->line);
  }
  return self->has_next;
}

static int32_t read_pose(void* handle, suture_device_pose* pose, char* why, size_t why_size) {
  poses* self = handle;
  const double now = seconds_since(&self->start);
  int32_t result = SUTURE_DEVICE_SAME;
  while (find_next(self) && self->next.seconds <= now) {
    *pose = self->next.pose;
    self->has_next = 0;
    result = SUTURE_DEVICE_NEW;
  }
  if (result == SUTURE_DEVICE_NEW || self->has_next || *self->end == '\0') return result;
  snprintf(why, why_size, "%s", self->end);
  return SUTURE_DEVICE_ENDED;
}

/* Who does not read its forces loses some. */
static void write_force(void* handle, const suture_device_force* felt) {
  const poses* self = handle;
  if (!self->is_socket) return;
  char line[200];
  const int size =
      snprintf(line, sizeof line, "%.9g %.9g %.9g %.9g %.9g %.9g\n", felt->force[0], felt->force[1],
               felt->force[2], felt->torque[0], felt->torque[1], felt->torque[2]);
  (void)!send(self->file, line, (size_t)size, MSG_NOSIGNAL | MSG_DONTWAIT);
}

static void close_poses(void* handle) {
  poses* self = handle;
  close(self->file);
  free(self);
}

__attribute__((visibility("default"))) const suture_device* suture_device_v1(void) {
  static const suture_device device = {sizeof(suture_device),
                                       SUTURE_DEVICE_VERSION,
                                       "poses",
                                       "Poses from a file, pipe or socket. Argument: its path.",
                                       open_poses,
                                       read_pose,
                                       write_force,
                                       close_poses};
  return &device;
}
