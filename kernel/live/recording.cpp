// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/recording.hpp"

#include <sstream>
#include <string_view>

#include "kernel/base/checksum.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/folder.hpp"
#include "kernel/base/input_file.hpp"
#include "kernel/live/inputs.hpp"
#include "kernel/live/json_text.hpp"

namespace suture {
namespace {

using Lines = nlohmann::ordered_json;  // the first key is that of the format

constexpr std::string_view beginning = R"({"recording":)";
constexpr int version = 1;

std::string line_of(const Lines& json) { return json_text(json) + "\n"; }

std::string file_text(const std::filesystem::path& path) {
  InputFile file(path);
  if (!file.problem().empty()) throw IoError(path.string() + ": " + file.problem());
  return file.read_text();
}

std::string line_of(const RecordedInput& input) {
  return line_of({{"step", input.step},
                  {"time", input.time},
                  {"device", input.device},
                  {"value", Lines::parse(input.value)}});
}
RecordedInput input_of(const Lines& line) {
  return {whole_number(line.at("step"), "its step"), line.value("time", 0.0), line.at("device"),
          line.at("value").dump()};
}

/// Refuses at the start what would fail at the first input.
void require_writable(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file))
    throw IoError(file.string() + ": is a folder; name a file for the recording");
  const Folder folder = Folder::open(file.parent_path());
  AtomicFile(folder, file.filename().string());  // leaves nothing
}

void read_header(const Lines& line, Recording& recording) {
  if (line.at("recording") != version)
    throw InputError("it has version " + line.at("recording").dump() + " of the format, not " +
                     std::to_string(version));
  recording.program = line.at("program");
  recording.isa = line.at("isa");
  recording.source = {line.at("scene").get<std::string>(),
                      line.at("file").get<std::string>(),
                      line.at("folder").get<std::string>(),
                      {}};
  recording.writes_results = line.value("results", true);
  recording.checkpoint = line.value("checkpoint", std::string());
  recording.first_step = recording.last_step =
      whole_number(line.value("step", Lines(0U)), "its step");
  recording.start = line.at("state");
}

/// Discards all inputs but the first ones; the run goes on from a step that lies between them and
/// the others.
void go_back(Recording& recording, std::uint64_t step, std::size_t inputs) {
  const std::vector<RecordedInput>& all = recording.inputs;
  if (inputs > all.size() || step < recording.first_step ||
      (inputs > 0 && step < all[inputs - 1].step) ||
      (inputs < all.size() && step > all[inputs].step))
    throw InputError("it goes back to a state that the lines above do not have");
  recording.inputs.resize(inputs);
  recording.last_step = step;
  recording.failure.clear();
}

void read_line(const Lines& line, Recording& recording) {
  const std::uint64_t step = whole_number(line.at("step"), "its step");
  if (line.contains("reset")) return go_back(recording, recording.first_step, 0);
  if (line.contains("back"))
    return go_back(recording, step, whole_number(line.at("inputs"), "its number of inputs"));
  if (!recording.failure.empty())
    throw InputError("the run has failed above, and it does not go back");
  if (step < recording.last_step) throw InputError("its step is before that of the line above");
  recording.last_step = step;
  if (line.contains("end"))
    recording.end = line.at("state");
  else if (line.contains("failed"))
    recording.failure = line.at("failed");
  else
    recording.inputs.push_back(input_of(line));
}

}  // namespace

std::string lines_of(std::span<const RecordedInput> inputs) {
  std::string lines;
  for (const RecordedInput& input : inputs) lines += line_of(input);
  return lines;
}

std::vector<RecordedInput> inputs_of(const std::string& lines) try {
  std::vector<RecordedInput> inputs;
  std::istringstream text(lines);
  for (std::string line; std::getline(text, line);) inputs.push_back(input_of(Lines::parse(line)));
  return inputs;
} catch (const Lines::exception& error) {
  throw InputError(std::string("its inputs are not understood: ") + error.what());
}

bool is_recording(const std::filesystem::path& path) {
  InputFile file(path);
  if (!file.problem().empty()) return false;
  std::string start(beginning.size(), ' ');
  return file.read(start) == start.size() && start == beginning;
}

Recording read_recording(const std::filesystem::path& path) {
  const std::string text = file_text(path);
  Recording recording;
  std::size_t number = 0, end = 0;
  for (std::size_t at = 0; (end = text.find('\n', at)) != text.npos; at = end + 1) {
    const auto refuse = [&](const std::string& why) {
      throw InputError(path.string() + ":" + std::to_string(number) + ": " + why +
                       "; expected a recording of suture live");
    };
    ++number;
    if (!recording.end.empty()) refuse("a line follows the end");
    try {
      const Lines line = Lines::parse(text.begin() + static_cast<std::ptrdiff_t>(at),
                                      text.begin() + static_cast<std::ptrdiff_t>(end));
      number == 1 ? read_header(line, recording) : read_line(line, recording);
    } catch (const Lines::exception& error) {
      refuse(error.what());
    } catch (const InputError& error) {
      refuse(error.what());
    }
  }
  if (number == 0) throw InputError(path.string() + ": it has no complete line");
  return recording;
}

bool repeat(const Recording& recording, const Scene& scene, Simulation& simulation,
            Observer& observer, Diagnostics& diagnostics) {
  if (state_hash(simulation) != recording.start)
    throw InputError(
        "the body is not that of the recording: its mesh or another file of the scene, or a value "
        "given by --set, has changed; restore it");
  const auto run_to = [&](std::uint64_t step) {
    if (simulation.step() < step) simulation.advance({{}, step - simulation.step()}, observer);
    return simulation.step() == step;  // it may end earlier
  };
  for (const RecordedInput& input : recording.inputs) {
    if (!run_to(input.step)) return false;
    apply_input(input.value, scene, simulation, observer, diagnostics);
  }
  if (!run_to(recording.last_step)) return false;
  if (!recording.failure.empty())
    diagnostics.warn("the live run failed here, and this run does not; it said: " +
                     recording.failure);
  return true;
}

void compare_end(const Recording& recording, Simulation& simulation, Diagnostics& diagnostics) {
  if (recording.end.empty() || state_hash(simulation) == recording.end) return;
  diagnostics.warn(
      recording.isa == simulation.isa()
          ? "the state differs from that at the end of the recording, which was made by " +
                recording.program
          : "the recording was made with the instruction set " + recording.isa +
                ", this run uses " + std::string(simulation.isa()) +
                ": states agree to within rounding only");
}

std::string state_hash(Simulation& simulation) {
  Checksum sum;
  const auto elements = simulation.complex().vertices();
  sum.add(std::as_bytes(std::span(elements)));
  Attributes& attributes = simulation.attributes();
  for (const Column* column : {&attributes.position(), &attributes.velocity()})
    for (Index v = 0; v < column->size(); ++v) {
      if (!simulation.complex().exists(0, v)) continue;
      sum.add(std::as_bytes(std::span(column->rows() + std::size_t{v} * 4, 3)));
    }
  return sum.text();
}

std::filesystem::path free_name(const std::filesystem::path& folder, const Scene& scene,
                                const std::string& what, const std::string& ending) {
  const std::string stem = scene.file.stem().string() + "-" + what;
  std::filesystem::path name = folder / (stem + ending);
  for (int i = 2; std::filesystem::exists(name); ++i)
    name = folder / (stem + "-" + std::to_string(i) + ending);
  return name;
}

RecordingWriter::RecordingWriter(std::optional<std::filesystem::path> file, const Scene& scene,
                                 Simulation& simulation, const std::filesystem::path& checkpoint)
    : path_(file.value_or("").empty() ? free_name("", scene, "recording", ".jsonl") : *file),
      first_step_(simulation.step()),
      is_on_(file.has_value()) {
  if (is_on_) require_writable(path_);
  Lines header{{"recording", version},
               {"program", "suture " SUTURE_VERSION},
               {"isa", std::string(simulation.isa())},
               {"file", scene.source.file.string()},
               {"folder", scene.source.working_folder.string()},
               {"results", scene.output.enabled}};
  if (!checkpoint.empty()) {
    header["checkpoint"] = std::filesystem::absolute(checkpoint).string();
    header["step"] = first_step_;
  }
  header["state"] = state_hash(simulation);
  header["scene"] = scene.source.text;
  header_ = line_of(header);
}

void RecordingWriter::write(const std::string& line) {
  if (!is_on_) return;
  try {
    if (!file_) {
      const Folder folder = Folder::open(path_.parent_path());
      file_ = std::make_unique<OutputFile>(folder, path_.filename().string());
      file_->write(header_);
    }
    file_->write(line);
  } catch (const IoError& error) {
    is_on_ = false;
    problem_ = error.what();
  }
}

void RecordingWriter::input(const RecordedInput& input) {
  write(line_of(input));
  ++inputs_;
}

void RecordingWriter::reset() {
  if (has_inputs()) write(line_of({{"step", first_step_}, {"reset", true}}));
  inputs_ = 0;
}

void RecordingWriter::back(std::uint64_t step, std::size_t inputs) {
  if (has_inputs()) write(line_of({{"step", step}, {"back", true}, {"inputs", inputs}}));
  inputs_ = inputs;
}

void RecordingWriter::failed(std::uint64_t step, const std::string& why) {
  if (has_inputs()) write(line_of({{"step", step}, {"failed", why}}));
}

Recording RecordingWriter::read() const {
  if (!problem_.empty())
    throw InputError("the recording, which is needed for this, has ended: " + problem_);
  try {
    return read_recording(path_);
  } catch (const IoError& error) {
    throw InputError(error.what());
  }
}

void RecordingWriter::end(Simulation& simulation) {
  if (!has_inputs() || !is_on_) return;
  write(line_of({{"step", simulation.step()}, {"end", true}, {"state", state_hash(simulation)}}));
  try {
    if (is_on_) file_->close();
  } catch (const IoError& error) {
    problem_ = error.what();
  }
}

}  // namespace suture
