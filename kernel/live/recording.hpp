// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/file.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {

/// What was done to a run, and between which steps.
struct RecordedInput {
  std::uint64_t step = 0;  ///< number of steps made before
  double time = 0;         ///< s
  std::string device;      ///< what it came from: "page", or the name of a device
  std::string value;       ///< JSON: apply_input()
};

/// A run with all inputs, as a file of JSON lines (docs/live.md).
struct Recording {
  SceneSource source;
  bool writes_results = true;         ///< false: frames were no stops of the clock
  std::string program, isa;           ///< that made it
  std::filesystem::path checkpoint;   ///< from which it begins; "": from the scene as built
  std::uint64_t first_step = 0;       ///< that of the checkpoint
  std::string start;                  ///< state_hash() there
  std::vector<RecordedInput> inputs;  ///< those that count, by step
  std::uint64_t last_step = 0;
  std::string end;      ///< state_hash() after the last step; "" if the program was killed, or
  std::string failure;  ///< why the last step failed
};

/// Inputs as lines of a recording, and back. The latter throws InputError.
std::string lines_of(std::span<const RecordedInput> inputs);
std::vector<RecordedInput> inputs_of(const std::string& lines);

/// Whether a file begins like a recording; false if it cannot be read.
bool is_recording(const std::filesystem::path& file);
/// Throws InputError with the line at fault. A last line without its end is ignored: the program
/// was killed while it wrote.
Recording read_recording(const std::filesystem::path& file);

/// Makes the steps of a recording and applies its inputs, from where it begins. Throws the errors
/// of the run, so that a recording that ends with a failure fails again, and InputError where the
/// body is not that of the recording. False if the run ended earlier or `observer` has stopped it.
bool repeat(const Recording& recording, const Scene& scene, Simulation& simulation,
            Observer& observer, Diagnostics& diagnostics);
/// Warns if the state differs from that at the end of the recording.
void compare_end(const Recording& recording, Simulation& simulation, Diagnostics& diagnostics);

/// The cells, positions and velocities: equal for equal bits. O(body).
std::string state_hash(Simulation& simulation);

/// NAME-WHAT.ENDING in a folder, where NAME is that of the scene's file; with a number if there is
/// such a file.
std::filesystem::path free_name(const std::filesystem::path& folder, const Scene& scene,
                                const std::string& what, const std::string& ending);

/// Writes a recording, each input at once. The file is created by the first input. Throws IoError
/// from the start if it cannot be created; if it cannot be written later, it ends.
class RecordingWriter {
 public:
  /// `file`: "" for a name made from that of the scene, which no file has yet; none: nothing is
  /// written. `checkpoint`: the file whose state `simulation` has; "" if it is as built.
  RecordingWriter(std::optional<std::filesystem::path> file, const Scene& scene,
                  Simulation& simulation, const std::filesystem::path& checkpoint = {});

  /// The file; it exists if has_inputs().
  const std::filesystem::path& path() const { return path_; }
  bool has_inputs() const { return file_ != nullptr; }
  /// Whether read() says what was done so far, or throws because the file lacks it.
  bool knows_inputs() const { return has_inputs() || !problem_.empty(); }
  void input(const RecordedInput& input);
  /// The number of inputs that count.
  std::size_t inputs() const { return inputs_; }
  /// The run starts again: what was done before no longer counts.
  void reset();
  /// The run goes on from an earlier step, before which it had this number of inputs.
  void back(std::uint64_t step, std::size_t inputs);
  void end(Simulation& simulation);
  /// The run has failed in its last step; back() or reset() may follow.
  void failed(std::uint64_t step, const std::string& why);
  /// What was written so far. Throws InputError if the file cannot be read any more.
  Recording read() const;
  /// Nothing more is written.
  void stop() { is_on_ = false; }
  bool is_on() const { return is_on_; }
  /// Why it has ended by itself, so that the file lacks inputs; "" if it has not.
  const std::string& problem() const { return problem_; }

 private:
  void write(const std::string& line);

  std::filesystem::path path_;
  std::string header_;
  std::uint64_t first_step_;
  std::unique_ptr<OutputFile> file_;
  bool is_on_;
  std::string problem_;
  std::size_t inputs_ = 0;
};

}  // namespace suture
