// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/motion.hpp"
#include "kernel/forces/body_share.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/output/frame_pieces.hpp"
#include "kernel/results/frame_parts.hpp"
#include "kernel/results/own_piece.hpp"
#include "kernel/vtk/vtk_module.hpp"

namespace suture {
namespace {

/// Every value of these tables is defined: what is not finite is a failure of the run.
void require_finite(const std::vector<double>& row, const char* table, BuiltScene& built) {
  if (std::ranges::all_of(row, [](double value) { return std::isfinite(value); })) return;
  built.dynamics().motion().require_finite_forces();  // names the node
  throw NotFinite(
      std::string("a value of ") + table +
      " is not finite; the forces or lengths of the scene are too large to compute with");
}

std::vector<std::string> grasp_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Event& event : scene.events)
    if (const auto* grasp = std::get_if<Grasp>(&event.what)) names.push_back(grasp->held.name);
  return names;
}

/// Returns the force of the body on a grasp, without the inertia of the nodes that it holds; the
/// torque about the mean of their places.
ContactLaw::Load grasp_load(const std::string& name, BuiltScene& built, const Vec3& gravity) {
  Attributes& attributes = built.body().attributes();
  const auto held = built.body().constraints().held_by(name);
  const auto row = [](const Column& column, Index v) {
    return Vec3{column.get(v, 0), column.get(v, 1), column.get(v, 2)};
  };
  Vec3 middle{};
  for (const auto& [v, components] : held)
    middle =
        plus(middle, scaled(1.0 / static_cast<double>(held.size()), row(attributes.position(), v)));
  ContactLaw::Load load;
  for (const auto& [v, components] : held) {
    Vec3 force = plus(row(attributes.force(), v), scaled(attributes.mass().get(v, 0), gravity));
    for (std::size_t c = 0; c < 3; ++c)
      if (!(components >> c & 1)) force[c] = 0;
    load.force = plus(load.force, force);
    load.torque = plus(load.torque, cross(minus(row(attributes.position(), v), middle), force));
  }
  return load;
}

std::vector<std::string> tool_columns(const ContactOptions& contact,
                                      const std::vector<std::string>& grasps) {
  using Quantities = std::vector<std::pair<const char*, const char*>>;
  const Quantities of_all{{" force ", " [N]"}, {" torque ", " [N m]"}};
  const Quantities of_compliant{{" hand force ", " [N]"},
                                {" hand torque ", " [N m]"},
                                {" position ", " [m]"},
                                {" rotation ", " [rad]"}};
  std::vector<std::string> columns{"time [s]"};
  const auto add = [&](const std::string& name, const Quantities& quantities) {
    for (const auto& [quantity, unit] : quantities)
      for (const char axis : {'x', 'y', 'z'}) columns.push_back(name + quantity + axis + unit);
  };
  for (const Obstacle& obstacle : contact.obstacles) {
    add(obstacle.name, of_all);
    if (obstacle.coupling) add(obstacle.name, of_compliant);
  }
  for (const std::string& name : grasps) add(name, of_all);
  return columns;
}

}  // namespace

Recorder::Recorder(const Scene& scene, BuiltScene& built, const EventRunner& events,
                   Provenance provenance, std::shared_ptr<OutputFolder> folder)
    : built_(built),
      events_(events),
      provenance_(std::move(provenance)),
      folder_(std::move(folder)) {
  const OutputOptions& options = scene.output;
  writes_ = options.enabled;
  in_pieces_ = options.pieces;
  if (!writes_) return;
  fields_ = choose_fields(built, options);
  frames_need_force_ = std::ranges::any_of(fields_, &FieldChoice::needs_force);
  frames_run_functors_ = std::ranges::any_of(fields_, &FieldChoice::runs_functors);
  other_fields_ = fields_besides(built, fields_);
  if (options.frames) frames_ = open_sink("frame", "run");
  sides_ = side_series(options, fields_, built, events);
  for (SideSeries& side : sides_) side.sink = open_sink(side.name, side.name);
  if (options.energies_every > 0) {
    std::vector<std::string> columns{"time [s]", "dt [s]", "kinetic [J]", "elastic [J]"};
    for (const auto& term : built.body().loads())
      columns.push_back(std::string(term->name()) + " [J]");
    const ContactLaw* contact = built.body().contact();
    if (contact && !contact->is_term()) columns.push_back("contact [J]");
    if (contact) columns.push_back("friction [J]");
    if (contact && contact->cutting_work()) columns.push_back("cutting [J]");
    columns.insert(columns.end(),
                   {"prescribed [J]", "models [J]", "events [J]", "dissipated [J]", "balance [J]"});
    for (const FieldEquation& field : built.body().fields()) {
      for (std::size_t c = 0; c < field.components(); ++c)
        for (const char* part : {"content", "inflow", "produced", "changed"})
          columns.push_back(field.name(c) + ' ' + part + " [" + field.unit_of_content() + ']');
      if (field.has_energy())
        for (const char* part : {" energy [J]", " dissipated [J]"})
          columns.push_back(field.field().name + part);
      if (field.has_dissipation()) columns.push_back(field.field().name + " supplied [J]");
    }
    if (events.debris().is_removed())
      columns.insert(columns.end(), {"body mass [kg]", "debris volume [m^3]", "debris mass [kg]",
                                     "debris momentum x [N s]", "debris momentum y [N s]",
                                     "debris momentum z [N s]", "debris energy [J]"});
    energies_ = std::make_unique<CsvWriter>(folder_, "energies.csv", columns);
  }
  if (options.probes_every > 0 && !options.probes.empty()) {
    probe_table_.emplace(options, built);
    probes_ = std::make_unique<CsvWriter>(folder_, "probes.csv", probe_table_->columns());
  }
  if (options.tools_every > 0) {
    grasps_ = grasp_names(scene);
    tools_ =
        std::make_unique<CsvWriter>(folder_, "tools.csv", tool_columns(scene.contact, grasps_));
  }
}

/// Files in the folder of the run; the one place that says where frames go.
std::unique_ptr<FrameSink> Recorder::open_sink(const char* prefix, const char* collection) const {
  FrameWriterOptions options = frame_options(built_.scene().output, folder_);
  options.prefix = prefix;
  options.collection = collection;
  return std::make_unique<FrameWriter>(std::move(options));
}

void Recorder::fill_frame(Frame& frame, double time, const Vec3& gravity,
                          const std::vector<Vec3>* mode) {
  frame.number = frame_number_;
  frame.time = time;
  frame.pieces = 0;
  set_geometry(frame, built_);
  const FieldRequest request{built_, gravity, time};
  fill_fields(fields_, FieldChoice::On::points, request, frame.point_fields);
  fill_fields(fields_, FieldChoice::On::cells, request, frame.cell_fields);
  if (mode != nullptr) {
    FrameField& field = frame.point_fields.emplace_back();
    field.name = "unstable_mode";
    field.components = 3;
    for (const Vec3& u : *mode) field.values.insert(field.values.end(), u.begin(), u.end());
  }
  frame.field_data_provenance = provenance_.line;
  leave_out(frame, built_);
}

void Recorder::frame(std::uint64_t step, double time, const Vec3& gravity) {
  if (!frames_) return;
  if (!process_0_fills_frames(step, time, gravity) && !each_fills_a_piece(step, time, gravity))
    fill_frames(step, time, gravity);
  ++frame_number_;
}

void Recorder::hold(std::uint64_t step, Frame frame) {
  pending_.push_back(
      {step, PendingRecord::Kind::frame, std::make_unique<Frame>(std::move(frame)), {}});
}

void Recorder::fill_frames(std::uint64_t step, double time, const Vec3& gravity) {
  Frame frame = frames_->take_frame();
  fill_frame(frame, time, gravity);
  hold(step, std::move(frame));
  fill_side_frames(step, time, gravity);
  if (!built_.skips()) fill_other_fields(time, gravity);
}

void Recorder::fill_side_frames(std::uint64_t step, double time, const Vec3& gravity) {
  for (std::size_t i = 0; i < sides_.size(); ++i) side_frame(i, step, time, gravity);
}

/// Where several processes make the run, it alone has memory for frames, unless each writes a
/// piece. False if that is not so, or if it fails: then all fill them, and meet the same error.
bool Recorder::process_0_fills_frames(std::uint64_t step, double time, const Vec3& gravity) {
  BodyShare* const share = built_.body().share();
  if (!share || in_pieces_) return false;
  const std::size_t before = pending_.size();
  bool is_good = true;
  gather_rows();
  if (share->number() == 0) {
    const PartialRows::OwnIsEnough as_they_are(built_.body().attributes().partial_rows());
    try {
      fill_frames(step, time, gravity);
    } catch (...) {
      is_good = false;
    }
  } else {
    pending_.push_back({step, PendingRecord::Kind::frame, nullptr, {}});
    for (std::size_t i = 0; i < sides_.size(); ++i)
      pending_.push_back({step, PendingRecord::Kind::side, nullptr, {}, i});
  }
  if (share->all(is_good)) return true;
  while (pending_.size() > before) pending_.pop_back();
  return false;
}

/// Whether a field is computed from the whole body, or all fields of the run are computed.
bool Recorder::has_fields_of_all() const {
  return !built_.skips() ||
         std::ranges::find(fields_, FieldChoice::From::all, &FieldChoice::from) != fields_.end();
}

/// Each process has a piece, computed from rows near it. False if frames are not made so, or if one
/// fails: then all fill whole frames, and meet the same error.
bool Recorder::each_fills_a_piece(std::uint64_t step, double time, const Vec3& gravity) {
  BodyShare* const share = built_.body().share();
  if (!share || !in_pieces_ || !built_.parts().empty() || has_fields_of_all()) return false;
  const CellComplex& complex = built_.body().complex();
  const std::size_t count = count_pieces(complex.existing(3), share->processes());
  const PieceCells piece = PieceCells::of(complex, share->number(), count);
  bool is_good = true;
  {
    const RowsAt rows(built_.body(), vertices_read_for(piece, built_, fields_));
    try {
      Frame frame = frames_->take_frame();
      fill_piece(frame, {built_, gravity, time, &piece}, count);
      hold(step, std::move(frame));
    } catch (...) {
      is_good = false;
    }
  }
  const bool has_piece = is_good;
  is_good = share->all(is_good);
  if (!is_good && has_piece) pending_.pop_back();
  if (is_good) fill_side_frames(step, time, gravity);
  return is_good;
}

void Recorder::fill_piece(Frame& frame, const FieldRequest& request, std::size_t count) {
  frame.number = frame_number_;
  frame.time = request.time;
  set_geometry(frame, built_, *request.piece);
  fill_fields(fields_, FieldChoice::On::points, request, frame.point_fields);
  fill_fields(fields_, FieldChoice::On::cells, request, frame.cell_fields);
  frame.field_data_provenance = provenance_.line;
  make_piece(frame, request.piece->points(request.complex()), count);
}

/// What fields may read.
void Recorder::gather_rows() {
  Attributes& attributes = built_.body().attributes();
  attributes.gather_motion();
  if (frames_need_force_ || !built_.skips()) attributes.force();
}

void Recorder::mode(double time, const Vec3& gravity, const std::vector<Vec3>& shape) {
  if (!writes_) return;
  tell_provenance();
  if (!modes_) modes_ = open_sink("mode", "mode");
  Frame frame = modes_->take_frame();
  fill_frame(frame, time, gravity, &shape);
  frame.number = modes_written_++;
  modes_->submit(std::move(frame));
}

/// Before the first file with results.
void Recorder::tell_provenance() {
  if (std::exchange(has_told_provenance_, true) || !provenance_.json) return;
  folder_->write("provenance.json", [&](OutputFile& file) { file.write(provenance_.json()); });
}

void Recorder::write(PendingRecord& record) {
  tell_provenance();
  switch (record.kind) {
    case PendingRecord::Kind::frame:
      if (record.frame) frames_->submit(std::move(*record.frame));
      break;
    case PendingRecord::Kind::side:
      if (record.frame) sides_[record.side].sink->submit(std::move(*record.frame));
      break;
    case PendingRecord::Kind::energies:
      energies_->row(record.step, record.row);
      break;
    case PendingRecord::Kind::probes:
      probes_->row(record.step, record.row);
      break;
    case PendingRecord::Kind::tools:
      tools_->row(record.step, record.row);
      break;
  }
}

void Recorder::release(std::uint64_t step) {
  while (!pending_.empty() && pending_.front().step <= step) {
    PendingRecord record = std::move(pending_.front());
    pending_.pop_front();  // even if writing fails, which leaves an empty one
    write(record);
  }
}

void Recorder::roll_back(std::uint64_t step) {
  for (; !pending_.empty() && pending_.back().step > step; pending_.pop_back())
    if (pending_.back().kind == PendingRecord::Kind::frame) --frame_number_;
}

std::size_t Recorder::frames_held() const {
  return static_cast<std::size_t>(
      std::ranges::count(pending_, PendingRecord::Kind::frame, &PendingRecord::kind));
}

/// Computed and dropped: a run that skips nothing pays for every field.
void Recorder::fill_other_fields(double time, const Vec3& gravity) {
  FrameField unused;
  for (const FieldChoice& field : other_fields_) field.fill({built_, gravity, time}, unused);
}

std::size_t Recorder::rehearse(double time, const Vec3& gravity) {
  if (!frames_) return 0;
  vtk_module();
  Frame frame = frames_->take_frame();
  fill_frame(frame, time, gravity);
  std::size_t bytes = frame.points.size() * sizeof(Vec3) +
                      frame.hexahedra.size() * sizeof(Hexahedron) +
                      frame.tetrahedra.size() * sizeof(frame.tetrahedra[0]);
  for (const auto* fields : {&frame.point_fields, &frame.cell_fields}) {
    for (const FrameField& field : *fields) bytes += 8 * (field.values.size() + field.ids.size());
  }
  return bytes;
}

void Recorder::side_frame(std::size_t side, std::uint64_t step, double time, const Vec3& gravity) {
  auto frame = std::make_unique<Frame>(sides_[side].sink->take_frame());
  frame->number = frame_number_;
  frame->time = time;
  frame->field_data_provenance = provenance_.line;
  sides_[side].fill(*frame, time, gravity);
  pending_.push_back({step, PendingRecord::Kind::side, std::move(frame), {}, side});
}

void Recorder::energies(std::uint64_t step, double time, double dt, const EnergyBalance& e) {
  std::vector<double> values{time, dt, e.kinetic, e.elastic};
  for (const EnergyBalance::Work& work : e.works) values.push_back(work.value);
  values.insert(values.end(), {e.prescribed, e.models, e.events, e.dissipated, e.balance});
  for (FieldEquation& field : built_.body().fields()) {
    for (std::size_t c = 0; c < field.components(); ++c) {
      const FieldBalance b = field.balance(c);
      values.insert(values.end(), {b.content, b.inflow, b.produced, b.changed});
    }
    if (!field.has_energy()) continue;
    const FieldEnergy own = field.energy(time);
    values.insert(values.end(), {own.stored, own.dissipated});
    if (field.has_dissipation()) values.push_back(own.supplied);
  }
  if (events_.debris().is_removed()) {
    const RemovedMatter& debris = events_.removed_debris();
    const Vec3& p = debris.momentum;
    const Column& mass = built_.body().attributes().mass();
    double body = 0;
    for (Index v = 0; v < mass.size(); ++v) body += mass.get(v, 0);
    values.insert(values.end(),
                  {body, debris.volume, debris.mass, p[0], p[1], p[2], debris.energy});
  }
  require_finite(values, "energies.csv", built_);
  pending_.push_back({step, PendingRecord::Kind::energies, nullptr, std::move(values)});
}

void Recorder::probes(std::uint64_t step, double time, const Vec3& gravity) {
  pending_.push_back(
      {step, PendingRecord::Kind::probes, nullptr, probe_table_->row(time, gravity)});
}

void Recorder::tools(std::uint64_t step, double time, const Vec3& gravity) {
  std::vector<double> values{time};
  const ContactLaw* contact = built_.body().contact();
  const auto add = [&](const Vec3& a) { values.insert(values.end(), a.begin(), a.end()); };
  const auto add_load = [&](const ContactLaw::Load& load) {
    add(load.force);
    add(load.torque);
  };
  for (std::size_t i = 0; contact && i < contact->obstacles().size(); ++i) {
    add_load(contact->loads()[i]);
    const auto tool = contact->tool_state(i);
    if (!tool) continue;
    add(tool->hand_force);
    add(tool->hand_torque);
    add(built_.frame().in_scene(tool->pose.place(tool->pose.centre)));
    add(rotation_vector(tool->pose));
  }
  for (const std::string& name : grasps_) add_load(grasp_load(name, built_, gravity));
  require_finite(values, "tools.csv", built_);
  pending_.push_back({step, PendingRecord::Kind::tools, nullptr, std::move(values)});
}

bool Recorder::probes_need(bool FieldChoice::*what) const {
  return probe_table_ && probe_table_->needs(what);
}

void Recorder::finish() {
  if (frames_) frames_->finish();
  for (SideSeries& side : sides_) side.sink->finish();
  if (modes_) modes_->finish();
  if (energies_) energies_->finish();
  if (probes_) probes_->finish();
  if (tools_) tools_->finish();
}

std::size_t Recorder::missing_frames() const {
  std::size_t missing = frames_ ? frames_->missing() : 0;
  for (const SideSeries& side : sides_) missing += side.sink->missing();
  return missing;
}

std::string Recorder::mode_collection() const { return modes_ ? modes_->collection() : ""; }

std::string Recorder::collection() const { return frames_ ? frames_->collection() : ""; }

/// Process 0 saves whole frames, joined from the pieces of all.
void Recorder::PendingRecord::state(Archive& archive, BodyShare* share) {
  archive("step", step);
  archive("kind", kind);
  archive("row", row);
  archive("side", side);
  if (kind != Kind::frame && kind != Kind::side) return;
  if (!archive.loads() && !frame) return;  // of a process that saves nothing
  if (archive.loads()) frame = std::make_unique<Frame>();
  if (frame->pieces == 0) return archive("frame", *frame);
  Frame whole = join_pieces(*frame, *share);
  if (share->number() == 0) archive("frame", whole);
}

void Recorder::state(Archive& archive) {
  bool had_files = has_files();
  archive("has files", had_files);
  archive("frame number", frame_number_);
  archive("modes written", modes_written_);
  archive.each("held", pending_, [&](Archive& each, PendingRecord& record) {
    record.state(each, built_.body().share());
  });
  begins_ = !had_files;
  if (had_files != has_files()) return pending_.clear();
  if (archive.loads() && modes_written_ > 0) modes_ = open_sink("mode", "mode");
  const auto writer = [&](const char* name, auto& file) {
    if (file) archive(name, *file);
  };
  writer("frames", frames_);
  for (SideSeries& side : sides_) archive(side.name, *side.sink);
  writer("modes", modes_);
  writer("energies", energies_);
  writer("probes", probes_);
  writer("tools", tools_);
}

}  // namespace suture
