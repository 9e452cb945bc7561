// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/output/csv_writer.hpp"
#include "kernel/output/frame_sink.hpp"
#include "kernel/results/fields.hpp"
#include "kernel/results/probe_table.hpp"
#include "kernel/results/provenance.hpp"
#include "kernel/results/side_series.hpp"

namespace suture {

/// Writes the results of a run: frames and side series, each to a sink of its own (FrameSink), and
/// energies.csv, probes.csv, tools.csv, and with the first record provenance.json.
/// Records are held back until release(), because their step may still be rejected. Nothing is
/// created on disk before the first record is released.
class Recorder {
 public:
  /// Throws InputError for fields or probes that the scene cannot provide.
  Recorder(const Scene& scene, BuiltScene& built, const EventRunner& events, Provenance provenance,
           std::shared_ptr<OutputFolder> folder);

  bool writes() const { return writes_; }
  bool writes_frames() const { return frames_ != nullptr; }
  bool writes_energies() const { return energies_ != nullptr; }
  bool writes_probes() const { return probes_ != nullptr; }
  bool writes_tools() const { return tools_ != nullptr; }
  bool has_grasps() const { return !grasps_.empty(); }
  const std::shared_ptr<OutputFolder>& folder() const { return folder_; }
  /// True if frames contain forces, which must match the current positions.
  bool frames_need_force() const { return frames_need_force_; }

  /// True if frames contain fields computed by functors of the models (stress).
  bool frames_run_functors() const { return frames_run_functors_; }

  /// The table of the probes; nullptr without probes.
  const ProbeTable* probe_table() const { return probe_table_ ? &*probe_table_ : nullptr; }
  /// True if some field of the probes has this property: probes_need(&FieldChoice::needs_force).
  bool probes_need(bool FieldChoice::*what) const;

  void frame(std::uint64_t step, double time, const Vec3& gravity);
  /// These two throw NumericalError for a value that is not finite, and record nothing.
  void energies(std::uint64_t step, double time, double dt, const EnergyBalance& row);
  void probes(std::uint64_t step, double time, const Vec3& gravity);
  void tools(std::uint64_t step, double time, const Vec3& gravity);
  /// Writes a separate file, mode_0000.vtu, listed in mode.pvd: the state with the fields of
  /// frames, and `shape` (per vertex) as the point field "unstable_mode".
  void mode(double time, const Vec3& gravity, const std::vector<Vec3>& shape);
  /// Writes everything recorded up to a step.
  void release(std::uint64_t step);
  /// Drops the records of the steps after this one, which are repeated.
  void roll_back(std::uint64_t step);
  /// The number of frames held back.
  std::size_t frames_held() const;
  /// For an estimate: fills a frame that is not written, and loads the modules that writing needs.
  /// Returns its bytes; 0 without output.
  std::size_t rehearse(double time, const Vec3& gravity);
  /// Waits until all is on disk. Throws IoError.
  void finish();

  std::size_t frames_written() const { return frame_number_; }
  /// Numbers later frames as if there had been so many.
  void skip_frames(std::size_t count) { frame_number_ = count; }
  std::string collection() const;
  /// The records on disk and those held back; later records are appended. A run with other results
  /// than the saved one begins its own.
  void state(Archive& archive);
  /// Whether the state that was loaded is that of a run without results.
  bool begins() const { return begins_; }
  /// The number of frames of the part before a resumption whose files are not in the folder.
  std::size_t missing_frames() const;
  std::string mode_collection() const;  ///< "" if no mode was written
  const std::vector<FieldChoice>& fields() const { return fields_; }
  /// The fields of this scene that were not chosen.
  const std::vector<FieldChoice>& other_fields() const { return other_fields_; }

 private:
  void fill_frame(Frame& frame, double time, const Vec3& gravity,
                  const std::vector<Vec3>* mode = nullptr);
  void fill_piece(Frame& frame, const FieldRequest& request, std::size_t count);
  void hold(std::uint64_t step, Frame frame);
  void fill_frames(std::uint64_t step, double time, const Vec3& gravity);
  void fill_side_frames(std::uint64_t step, double time, const Vec3& gravity);
  bool process_0_fills_frames(std::uint64_t step, double time, const Vec3& gravity);
  bool each_fills_a_piece(std::uint64_t step, double time, const Vec3& gravity);
  bool has_fields_of_all() const;
  void gather_rows();
  void side_frame(std::size_t side, std::uint64_t step, double time, const Vec3& gravity);
  void fill_other_fields(double time, const Vec3& gravity);

  /// A record that may still be dropped.
  struct PendingRecord {
    std::uint64_t step = 0;
    enum class Kind { frame, side, energies, probes, tools } kind = Kind::frame;
    /// For the first two kinds; null where another process has it, or a piece.
    std::unique_ptr<Frame> frame;
    std::vector<double> row;  ///< for the others
    std::size_t side = 0;     ///< the series
    void state(Archive& archive, BodyShare* share);
  };
  bool has_files() const { return frames_ || energies_ || probes_ || tools_; }
  void tell_provenance();
  void write(PendingRecord& record);
  std::unique_ptr<FrameSink> open_sink(const char* prefix, const char* collection) const;

  BuiltScene& built_;
  const EventRunner& events_;
  Provenance provenance_;
  bool has_told_provenance_ = false;
  std::shared_ptr<OutputFolder> folder_;
  std::vector<FieldChoice> fields_, other_fields_;
  bool writes_ = false, begins_ = false, frames_need_force_ = false, frames_run_functors_ = false;
  bool in_pieces_ = false;
  std::size_t frame_number_ = 0;
  std::deque<PendingRecord> pending_;
  std::optional<ProbeTable> probe_table_;
  std::unique_ptr<FrameSink> frames_, modes_;
  std::vector<SideSeries> sides_;
  std::size_t modes_written_ = 0;
  std::vector<std::string> grasps_;  ///< in tools.csv
  std::unique_ptr<CsvWriter> energies_, probes_, tools_;
};

}  // namespace suture
