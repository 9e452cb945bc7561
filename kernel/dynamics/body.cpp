// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/body.hpp"

#include <algorithm>
#include <numeric>

#include "kernel/base/sort_unique.hpp"
#include "kernel/contact/contact.hpp"
#include "kernel/topology/marks.hpp"

namespace suture {

Body::Body(Imported imported)
    : imported_(std::move(imported)),
      attributes_(imported_.complex, std::exchange(imported_.rest, {})),
      user_vertex_(std::move(imported_.user_vertex)) {
  user_vertex_.reserve(2 * user_vertex_.size());  // for those that cuts make, like columns
  name_elements({});
  attributes_.set_parts(imported_.complex, std::exchange(imported_.parts, {}));
}

Body::~Body() = default;

void Body::name_elements(std::vector<Index> names) {
  element_names_ = std::move(names);
  attributes_.user_element = element_names_.empty() ? imported_.user_element.list()
                                                    : std::span<const Index>(element_names_);
}

void Body::compile(Diagnostics& diagnostics, unsigned threads) {
  attributes_.initialise(complex(), diagnostics);
  auto models = std::make_unique<ForceLoop>(attributes_, complex(), threads);
  models_ = models.get();
  terms_.insert(terms_.begin(), std::move(models));  // whatever was added before
  for (const VertexField& field : attributes_.fields())
    fields_.emplace_back(attributes_, complex(), field, threads);
}

FieldEquation& Body::field(std::string_view name) {
  return *std::ranges::find_if(
      fields_, [&](const FieldEquation& equation) { return equation.field().name == name; });
}

void Body::share(std::unique_ptr<BodyShare> share) {
  share_ = std::move(share);
  models_->share(*share_, [this](std::vector<bool>& marks) { mark_vertices(marks); });
  attributes_.partial_rows().share_with(
      {.complete =
           [this](double* rows) {
             share_->complete({rows, 4});
           },
       .complete_at_cells = [this](double* rows) { share_->complete_at_cells(rows); },
       .gather =
           [this](double* rows) {
             share_->gather({rows, 4});
           },
       .known =
           [this] {
             if (!models_->knows_share()) models_->find_share();
             return share_->known();
           }});
  for_each_with<SharedTerm>(terms_, [&](SharedTerm& term) { term.divide_sums(*share_); });
}

void Body::share_with(ForceTerm& added) {
  if (auto* term = dynamic_cast<SharedTerm*>(&added)) term->divide_sums(*share_);
  models_->find_share();
}

bool Body::marks_vertices() const {
  return (!contact_ || contact_->is_term() || contact_->marks_vertices()) &&
         std::ranges::all_of(loads(), [](const auto& term) { return term->marks_vertices(); });
}

/// Also of terms that read others, too: then nothing is divided.
void Body::mark_vertices(std::vector<bool>& marks) const {
  constraints_.mark_driven(marks);
  for (const auto& term : loads()) term->mark_vertices(marks);
  if (contact_) contact_->mark_vertices(marks);
}

void Body::check_plugins() {
  models_->check_plugins();
  for (FieldEquation& field : fields_) field.rates().check_plugins();
}

void Body::measure() {
  models_->measure();
  for (FieldEquation& field : fields_) field.rates().measure();
}

std::vector<FunctorCost> Body::costs() const {
  std::vector<FunctorCost> costs = models_->costs();
  for (const FieldEquation& field : fields_)
    for (FunctorCost& cost : field.rates().costs()) costs.push_back(std::move(cost));
  return costs;
}

Contact& Body::add_contact(std::vector<Obstacle> obstacles, double thickness,
                           std::function<const Embedding&()> embedding) {
  auto contact = std::make_unique<Contact>(complex(), attributes_, std::move(obstacles), thickness,
                                           std::move(embedding));
  Contact& added = *contact;
  contact_ = std::move(contact);
  return added;
}

// -------------------------------------------------------------------- terms --

Vec3 Body::acceleration(double time) const {
  Vec3 sum{};
  for (const auto& term : terms_) {
    const Vec3 a = term->acceleration(time);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += a[c];
  }
  return sum;
}

double Body::energy(double time) const {
  double sum = 0;
  for_each_with<EnergyTerm>(terms_, [&](EnergyTerm& term) { sum += term.energy(time); });
  return sum;
}

double Body::potential(double time) const {
  double sum = 0;
  for_each_with<EnergyTerm>(terms_, [&](EnergyTerm& term) { sum += term.potential(time); });
  return sum;
}

bool Body::has_loads() const {
  return !std::ranges::all_of(loads(), [](const auto& term) { return term->adds_no_rows(); });
}

bool Body::is_conservative(double time) const {
  return models_->is_conservative(time) && has_conservative_loads(time);
}

bool Body::has_conservative_loads(double time) const {
  return std::ranges::all_of(loads(), [&](const auto& term) {
    auto* tangent = dynamic_cast<TangentTerm*>(term.get());
    return !tangent || tangent->is_conservative(time);
  });
}

bool Body::has_transpose(double time) const {
  return std::ranges::all_of(terms_, [&](const auto& term) {
    auto* tangent = dynamic_cast<TangentTerm*>(term.get());
    return !tangent || tangent->has_transpose(time);
  });
}

double Body::last_change() const {
  double last = constraints_.last_change();
  for (const FieldEquation& field : fields_) last = std::max(last, field.last_change());
  if (contact_) last = std::max(last, contact_->last_change());
  for (const auto& term : terms_) last = std::max(last, term->last_change());
  return last;
}

bool Body::has_free_vertices() {
  const double* mass = attributes_.mass().rows();
  const double* fixed = attributes_.fixed().rows();
  for (Index v = 0; v < attributes_.vertex_count(); ++v)
    if (mass[v] > 0 && static_cast<int>(fixed[v]) != 7) return true;
  return false;
}

void Body::add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                       double* out) const {
  for_each_with<TangentTerm>(terms_, [&](TangentTerm& term) {
    if (term.has_tangent()) term.add_tangent(d, dx, dv, at, out);
  });
}

std::vector<Vec3> Body::forces_at(std::span<const Index> vertices, double time) {
  std::vector<Vec3> forces(vertices.size());
  if (vertices.empty()) return forces;
  selection_.select(vertices, attributes_.vertex_count());
  for (const auto& term : terms_) term->add_forces_at(selection_, vertices, time, forces);
  return forces;
}

// --------------------------------------------------------------- operations --

namespace {

/// Those from `least` to `most` that for_each(visit) visits, `count` in all: ascending, each once.
/// Where they are many, marks take a tenth of the time of sorting.
template <class ForEach>
std::vector<Index> each_once(Index least, Index most, std::size_t count, ForEach for_each) {
  std::vector<Index> vertices;
  if ((most - least) / 64 >= count) {
    vertices.reserve(count);
    for_each([&](Index v) { vertices.push_back(v); });
    sort_unique(vertices);
    return vertices;
  }
  std::vector<std::uint64_t> marks((most - least) / 64 + 1);
  for_each([&](Index v) { marks::mark(marks, v - least); });
  vertices = marks::marked(marks);
  for (Index& v : vertices) v += least;
  return vertices;
}

/// The corners of faces, ascending, each once.
std::vector<Index> corners_of(const CellComplex& complex, std::span<const Dart> faces) {
  return each_once(0, complex.count(0), 4 * faces.size(), [&](auto visit) {
    for (const Dart d : faces)
      for (const auto node : suture_hexahedron_faces[local_face(d)])
        visit(complex.vertices_of(element_of(d))[node]);
  });
}

/// Ascending, each once.
std::vector<Index> sorted_once(const std::vector<Index>& vertices) {
  if (vertices.empty()) return {};
  const auto [least, most] = std::ranges::minmax(vertices);
  return each_once(least, most, vertices.size(),
                   [&](auto visit) { std::ranges::for_each(vertices, visit); });
}

}  // namespace

template <class Operate>
TopologyChange Body::change(const ComingOperation& operation, Operate operate) {
  for (Follower* follower : followers_) follower->before(operation);
  for (FieldEquation& field : fields_) field.before_operation();
  TopologyChange change = operate();
  follow(change);
  return change;
}

/// Copies have the numbers of the elements of the mesh from which they come.
void Body::name_copies(std::span<const Index> imported) {
  if (imported.empty()) return;
  std::vector<Index> numbers, names = std::move(element_names_);
  const bool has_names = !names.empty();
  for (const Index e : imported) {
    numbers.push_back(imported_.user_element[e]);
    if (has_names) names.push_back(names[e]);
  }
  imported_.user_element.append(imported_elements(), numbers);
  name_elements(std::move(names));
}

void Body::follow_copies(const TopologyChange& change) {
  const Index imported = imported_elements() - static_cast<Index>(change.copies.size());
  std::vector<Index> origins;
  for (const auto& [origin, copy] : change.copies)
    origins.push_back(origin < imported ? origin : copied_element_[origin - imported]);
  copied_element_.insert(copied_element_.end(), origins.begin(), origins.end());
  name_copies(origins);
}

/// The one place where anything follows a change.
void Body::follow(const TopologyChange& change) {
  for (const Split& split : change.splits[0]) user_vertex_.push_back(user_vertex_[split.old_cell]);
  follow_copies(change);
  attributes_.apply(complex(), change);
  if (share_ && !change.empty()) share_->follow(complex());  // all rows are complete
  for (const auto& term : terms_) term->follow(complex(), change);
  for (FieldEquation& field : fields_) field.follow(complex(), change);
  constraints_.update(change, attributes_);
  if (contact_) contact_->follow(complex(), change);
  if (islands_) islands_->update(complex(), change);
  if (blocks_at_rest_ && change.copies.empty())
    blocks_at_rest_->follow(complex(), change, {attributes_.rest().rows()});
  else
    blocks_at_rest_.reset();
  for (Follower* follower : followers_) follower->follow(complex(), change);
}

void Body::make_room(Index faces, Index largest) {
  imported_.complex.make_room(faces, largest);
  attributes_.make_room(faces, largest);
  models_->make_room(faces);
  for (FieldEquation& field : fields_) field.rates().make_room(faces);
  suture::make_room(user_vertex_, cells_of_cut(faces)[0]);
}

TopologyChange Body::cut(const std::vector<Dart>& faces) {
  const std::vector<Index> vertices = corners_of(complex(), faces);
  return change({vertices, true}, [&] { return complex().cut(faces); });
}

TopologyChange Body::pierce(const std::vector<Index>& elements) {
  std::vector<Index> vertices;
  for (const Index e : elements)
    vertices.insert(vertices.end(), complex().vertices_of(e).begin(),
                    complex().vertices_of(e).end());
  vertices = sorted_once(vertices);
  return change({vertices, false}, [&] { return complex().pierce(elements); });
}

TopologyChange Body::clone_volume(const Cloning& cloning, const Parts& parts,
                                  const std::function<void()>& is_cloned) {
  std::vector<Index> vertices;
  const auto add = [&](Index element) {
    const Hexahedron& nodes = complex().vertices_of(element);
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
  };
  for (const Index e : cloning.origins) add(e);
  for (const Dart d : cloning.cut) add(element_of(d));
  std::vector<std::pair<Index, Index>> equal;
  for (const auto& [element, copy] : cloning.absorbed) {
    const Index origin = cloning.origins[copy - complex().element_count()];
    for (std::size_t n = 0; n < hexahedron::vertices; ++n)
      equal.emplace_back(complex().vertices_of(element)[n], complex().vertices_of(origin)[n]);
    add(element);
  }
  vertices = equal.empty() ? sorted_once(vertices) : around(std::move(vertices));
  TopologyChange done = change({vertices, false}, [&] {
    attributes_.bring_together(equal);
    attributes_.begin_copies(complex(), parts, cloning.origins);
    TopologyChange change = complex().clone_volume(cloning);
    is_cloned();
    return change;
  });
  attributes_.end_copies();
  return done;
}

/// Vertices that meet move, and change the forces on all vertices of the elements around them.
TopologyChange Body::sew(const std::vector<Seam>& seams) {
  std::vector<Index> vertices;
  for (const Seam& seam : seams)
    for (const Dart side : {seam.one, seam.other})
      for (const auto node : suture_hexahedron_faces[local_face(side)])
        vertices.push_back(complex().vertices_of(element_of(side))[node]);
  vertices = around(std::move(vertices));
  return change({vertices, false}, [&] { return complex().sew(seams); });
}

/// Returns the vertices of all elements around some, each once.
std::vector<Index> Body::around(std::vector<Index> vertices) const {
  std::vector<Index> elements;
  std::vector<Dart> star;
  sort_unique(vertices);
  for (const Index v : vertices) {
    star.clear();
    complex().star(0, v, star);
    for (const Dart d : star) elements.push_back(element_of(d));
  }
  sort_unique(elements);
  for (const Index e : elements) {
    const Hexahedron& nodes = complex().vertices_of(e);
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
  }
  return sorted_once(vertices);
}

std::vector<Index> Body::origins() const {
  std::vector<Index> origins(imported_elements());
  std::iota(origins.begin(), origins.end(), Index{0});
  origins.insert(origins.end(), copied_element_.begin(), copied_element_.end());
  return origins;
}

const Islands& Body::islands() {
  if (!islands_) islands_.emplace(complex());
  return *islands_;
}

const ElementBlocks& Body::blocks_at_rest() {
  if (!blocks_at_rest_) blocks_at_rest_.emplace(complex(), Places{attributes_.rest().rows()});
  return *blocks_at_rest_;
}

// -------------------------------------------------------------------- state --

void Body::state(Archive& archive) {
  if (archive.has_cells()) {
    attributes_.parameters(archive, complex());
    archive("complex", imported_.complex);
    archive("user vertex", user_vertex_);
    if (archive.loads()) blocks_at_rest_.reset();
    if (attributes_.parts().may_grow()) {
      archive("copied elements", copied_element_);
      if (archive.loads()) name_copies(copied_element_);
    }
    bool has_islands = islands_.has_value();
    archive("has islands", has_islands);
    if (archive.loads()) islands_.reset();
    if (archive.loads() && has_islands) islands_.emplace(complex());  // with copies
    if (has_islands) archive("islands", *islands_);
  }
  archive("attributes", attributes_);
  archive("constraints", constraints_);
  if (archive.has_cells() && archive.loads()) constraints_.mark(attributes_);
  if (contact_) archive("contact", *contact_);
  archive.group("terms", [&] {
    for (const auto& term : terms_) archive(term->name(), *term);
  });
  for (FieldEquation& field : fields_) archive(("field " + field.field().name).c_str(), field);
  if (archive.has_cells() && archive.loads() && share_) {
    share_->divide(complex());
    models_->find_share();  // a pass may follow without another evaluation
  }
}

}  // namespace suture
