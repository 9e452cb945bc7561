// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "kernel/geometry/rotation.hpp"
#include "suture/device.h"

namespace suture {

inline Vec3 position_of(const suture_device_pose& pose) { return std::to_array(pose.position); }
inline Rotation turn_of(const suture_device_pose& pose) {
  return turned(std::to_array(pose.rotation), no_rotation);
}

/// What a hand feels around a pose: a force and a spring that resists leaving that pose, so that
/// the hand feels its own motion at once, however rarely the run finds new forces.
struct FeltForce {
  Vec3 force{}, torque{};  ///< N, N m, at `at`
  suture_device_pose at{};
  double stiffness = 0, turning_stiffness = 0;  ///< N/m, N m/rad

  suture_device_force at_pose(const suture_device_pose& pose) const;
};

/// A device (suture/device.h) with a thread of its own, which reads it and gives it a force 1000
/// times per second. The functions never wait for the device.
class Device {
 public:
  /// `text`: NAME, FILE.so, NAME:ARGUMENT or FILE.so:ARGUMENT. Throws PluginError if there is no
  /// such library, if it is not a device of this version, or if it does not open.
  explicit Device(const std::string& text);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const std::string& name() const;  ///< by which recordings name it
  suture_device_pose pose() const;  ///< the last one
  /// What it gives the hand until the next call.
  void set_force(const FeltForce& force);
  Vec3 force() const;  ///< that it gave last, N
  /// Once, when the device sends nothing more or does not answer: a message.
  std::string take_problem();
  double rate() const;  ///< of reads, per second, in the last half second

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< also the thread's, which outlives this if it hangs
  std::thread thread_;
};

/// NAME.so in the folder `devices` of a folder of plugins, or a file that ends in ".so". Throws
/// PluginError with the folders and the devices that are there.
std::filesystem::path device_file(const std::string& name);
/// The table of a library. Throws PluginError with the reason if it is not a device of this
/// version.
const suture_device& load_device(const std::filesystem::path& file);

}  // namespace suture
