// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/simulation.hpp"

#include "kernel/base/error.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/run/run_loop.hpp"

namespace suture {

Simulation::Simulation(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, bool skip,
                       std::shared_ptr<OutputFolder> folder, bool check_plugins,
                       Communicator* processes) {
  if (!folder) folder = std::make_shared<OutputFolder>(scene.output.directory, scene.output.root);
  try {
    run_ = std::make_unique<RunLoop>(scene, host, diagnostics, skip, std::move(folder),
                                     check_plugins, processes);
  } catch (const InputError& error) {
    scene.places.rethrow(error);
  }
}

Simulation::~Simulation() = default;

void Simulation::resume(const Checkpoint& checkpoint, const std::filesystem::path& file) {
  run_->resume(checkpoint, file);
}

RunSummary Simulation::run(Observer& observer) { return run_->run(observer); }

std::optional<RunSummary::Outcome> Simulation::advance(const Pause& pause, Observer& observer) {
  return run_->advance(pause, observer);
}

double Simulation::time() const { return run_->control().clock().time(); }

std::uint64_t Simulation::step() const { return run_->control().clock().step(); }

double Simulation::next_dt() { return run_->control().next_dt(); }

EventOutcome Simulation::apply(const Event& event, Observer& observer) {
  return run_->apply(event, observer);
}

void Simulation::change_motion(const std::function<void(Attributes&)>& change) {
  run_->change_motion(change);
}

void Simulation::steer(const std::string& obstacle, const PoseTarget& target) {
  run_->steer(obstacle, target);
}

void Simulation::move_grasp(const std::string& grasp, const Vec3& translation, double duration) {
  run_->move_grasp(grasp, translation, duration);
}

Vec3 Simulation::force_on_grasp(const std::string& grasp) {
  Body& body = built().body();
  const auto held = body.constraints().held_by(grasp);
  Vec3 sum{};
  if (held.empty()) return sum;
  built().dynamics().synchronise();
  const Vec3 gravity = body.acceleration(time());
  for (const auto& [vertex, components] : held)
    for (std::size_t c = 0; c < 3; ++c)
      if ((components >> c & 1) != 0)
        sum[c] += attributes().force().rows()[4 * std::size_t{vertex} + c] +
                  attributes().mass().get(vertex, 0) * gravity[c];
  return sum;
}

ForceTerm& Simulation::add_term(std::unique_ptr<ForceTerm> term) {
  return run_->add_term(std::move(term));
}

void Simulation::set_parameters(Instance& instance, std::vector<double> values) {
  run_->set_parameters(instance, std::move(values));
}

void Simulation::set_field(Instance& instance, std::size_t parameter, std::vector<double> values) {
  run_->set_field(instance, parameter, std::move(values));
}

void Simulation::set_gravity(const Vec3& value) { run_->set_gravity(value); }

void Simulation::equilibrate(Observer& observer) { run_->equilibrate(observer); }

StateTree Simulation::save(StateTree* spare) { return run_->save(spare); }

void Simulation::load(const StateTree& state) { run_->load(state); }

BuiltScene& Simulation::built() { return run_->built(); }

Energies Simulation::energies() { return suture::energies(run_->built().dynamics()); }

double Simulation::balance() const {
  return run_->built().dynamics().is_static() ? 0 : run_->control().guard().open_balance();
}

void Simulation::measure() { run_->built().body().measure(); }

std::vector<FunctorCost> Simulation::costs() const { return run_->built().body().costs(); }

void Simulation::try_plugins() {
  ForceLoop& models = run_->built().body().models();
  AlignedVector<double> rows(std::size_t{attributes().vertex_count()} * 4);
  models.add_forces(0, 0, ForceLoop::Part::all, rows.data());
  models.energy(0);
}

unsigned Simulation::threads() const { return run_->built().body().models().threads(); }

std::string_view Simulation::isa() const { return run_->built().body().models().isa(); }

const std::vector<Decision>& Simulation::decisions() const { return run_->decisions(); }

const CellComplex& Simulation::complex() const { return run_->built().body().complex(); }

const ContactLaw* Simulation::contact() const { return run_->built().body().contact(); }

std::vector<BladeShape> Simulation::blades() const { return run_->events().blades(time()); }

const std::optional<FailedPiece>& Simulation::failed_piece() const {
  return run_->control().failed_piece();
}

Attributes& Simulation::attributes() { return run_->built().body().attributes(); }

Vec3 Simulation::origin() const { return run_->built().frame().origin; }

Vec3 Simulation::mean_displacement(const Selection& selection) const {
  const Selection local = in_frame(selection, run_->built().frame());
  const std::vector<Index> vertices = run_->built().selector().vertices(local);
  const Column &x = run_->built().body().attributes().position(),
               &rest = run_->built().body().attributes().rest();
  Vec3 mean{};
  for (const Index v : vertices) {
    for (int a = 0; a < 3; ++a) {
      mean[static_cast<std::size_t>(a)] +=
          (x.get(v, a) - rest.get(v, a)) / static_cast<double>(vertices.size());
    }
  }
  return mean;
}

}  // namespace suture
