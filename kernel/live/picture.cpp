// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/picture.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "kernel/base/vec3.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/geometry/shape_mesh.hpp"
#include "kernel/live/json_text.hpp"

namespace suture {
namespace {

using Json = nlohmann::json;
using Wall = std::chrono::steady_clock;
/// Between two points of the curves: at least, and as a multiple of the time that they take.
constexpr std::chrono::nanoseconds plot_interval = std::chrono::milliseconds(100);
constexpr int plot_share = 50;
static_assert(std::endian::native == std::endian::little, "messages are little-endian");

template <class T>
void append(std::string& message, std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  message.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// The length of the JSON text, the text, and blanks up to a multiple of four bytes.
std::string begin_message(const Json& json, std::size_t array_bytes) {
  std::string text = json_text(json);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string message;
  message.reserve(4 + text.size() + array_bytes);
  append(message, std::span(&length, 1));
  return message + text;
}

Json mesh_json(const Obstacle& obstacle, const ContactLaw& contact) {
  Vec3 middle;
  for (std::size_t c = 0; c < 3; ++c)
    middle[c] = (contact.box().low[c] + contact.box().high[c]) / 2;
  const ShapeMesh mesh = mesh_of(obstacle.shape, middle, contact.size());
  Json points = Json::array(), triangles = Json::array();
  for (const Vec3& point : mesh.points)
    for (const double x : point) points.push_back(static_cast<float>(x));
  for (const auto& face : mesh.faces) {
    for (const std::size_t k : {0, 1, 2}) triangles.push_back(face[k]);
    if (face[3] == none) continue;
    for (const std::size_t k : {0, 2, 3}) triangles.push_back(face[k]);
  }
  return {{"name", obstacle.name}, {"points", points}, {"triangles", triangles}};
}

/// The columns of the matrix that places what is given: three axes and an origin.
Json pose_json(const Pose& pose) {
  Json columns = Json::array();
  for (std::size_t c = 0; c < 3; ++c) {
    Vec3 axis{};
    axis[c] = 1;
    for (const double x : pose.direction(axis)) columns.push_back(x);
  }
  for (const double x : pose.place({})) columns.push_back(x);
  return columns;
}

/// The lines of the blades that move, as coordinates in the frame of the body.
Json blades_json(const Simulation& simulation) {
  Json blades = Json::array();
  for (const BladeShape& blade : simulation.blades()) {
    if (!blade.triangles.empty()) continue;
    Json points = Json::array();
    for (const Vec3& point : blade.points)
      for (const double x : point) points.push_back(static_cast<float>(x));
    blades.push_back(points);
  }
  return blades;
}

Json device_json(const LiveStatus::Device& device) {
  return {{"name", device.name},
          {"place", device.place},
          {"rotation", device.rotation},
          {"force", device.force},
          {"poses_per_second", device.poses_per_second},
          {"exchanges_per_second", device.exchanges_per_second}};
}

Json range_of(std::span<const float> values) {
  float low = INFINITY, high = -INFINITY;
  for (const float value : values)
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  return low <= high ? Json{low, high} : Json{0, 0};
}

/// The mean length of the three edges at the first corner of each element.
double mean_edge(const CellComplex& complex, const Column& rest) {
  double sum = 0;
  const auto place = [&](Index v) { return Vec3{rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)}; };
  for (Index e = 0; e < complex.element_count(); ++e) {
    const auto corners = complex.vertices_of(e);
    for (const std::size_t k : {1, 2, 4}) sum += norm(minus(place(corners[k]), place(corners[0])));
  }
  return sum / (3.0 * complex.element_count());
}

}  // namespace

Pictures::Pictures(Simulation& simulation, std::uint64_t first_number)
    : simulation_(simulation),
      surface_(simulation.built()),
      plots_(simulation),
      fields_(shown_fields(simulation.built())),
      first_number_(first_number),
      last_number_(first_number),
      edge_length_(mean_edge(simulation.complex(), simulation.attributes().rest())) {
  choose("displacement");
}

Json Pictures::greeting() const {
  Json fields = Json::array(), obstacles = Json::array();
  for (const FieldChoice& field : fields_)
    fields.push_back({{"name", field.name}, {"unit", field.unit}});
  if (const ContactLaw* contact = simulation_.contact())
    for (const Obstacle& obstacle : contact->obstacles())
      obstacles.push_back(mesh_json(obstacle, *contact));
  const Scene& scene = simulation_.built().scene();
  return {{"live", 1},
          {"title", scene.title.empty() ? scene.file.filename().string() : scene.title},
          {"origin", simulation_.origin()},
          {"gravity", scene.gravity},
          {"elements", simulation_.complex().existing(3)},
          {"edge", edge_length_},
          {"fields", fields},
          {"plots", plots_.names()},
          {"obstacles", obstacles}};
}

void Pictures::choose(const std::string& field) {
  field_ = static_cast<std::size_t>(&field_named(fields_, field, "field") - fields_.data());
}

void Pictures::plot() {
  const auto start = Wall::now();
  if (start < next_plot_) return;
  plotted_ = plots_.values();
  const auto end = Wall::now();
  next_plot_ = end + std::max(plot_interval, plot_share * (end - start));
}

LivePicture Pictures::picture(const LiveStatus& status) {
  const std::uint64_t number = first_number_ + surface_.number();
  if (number != last_number_ || !surface_text_) {
    last_number_ = number;
    surface_text_ = std::make_shared<const std::string>(surface_message());
  }
  return {number, surface_text_, std::make_shared<const std::string>(state_message(status))};
}

std::string Pictures::surface_message() {
  std::string message = begin_message({{"kind", "surface"},
                                       {"surface", last_number_},
                                       {"points", surface_.size()},
                                       {"faces", surface_.face_count()},
                                       {"corners", surface_.corners_per_face()},
                                       {"laid_open", surface_.laid_open()}},
                                      4 * surface_.corners().size() + 12 * surface_.size());
  append(message, surface_.corners());
  std::vector<float> rest;
  rest.reserve(3 * surface_.size());
  surface_.append_rest(rest);
  append(message, std::span<const float>(rest));
  return message;
}

std::string Pictures::state_message(const LiveStatus& status) {
  const double time = simulation_.time();
  std::vector<float> positions, values;
  positions.reserve(3 * surface_.size());
  values.reserve(surface_.size());
  surface_.append_positions(positions);
  const Vec3 gravity = simulation_.built().body().acceleration(time);
  surface_.append_values(fields_[field_], gravity, time, values);

  Json poses = Json::array();
  if (const ContactLaw* contact = simulation_.contact())
    for (std::size_t i = 0; i < contact->obstacles().size(); ++i)
      poses.push_back(pose_json(contact->pose(i, time)));
  Json head{{"kind", "state"},
            {"surface", last_number_},
            {"time", time},
            {"step", simulation_.step()},
            {"playing", status.is_playing},
            {"ended", status.has_ended},
            {"speed", status.speed},
            {"steps_per_second", status.steps_per_second},
            {"real_time", status.real_time},
            {"balance", simulation_.balance()},
            {"field", fields_[field_].name},
            {"range", range_of(values)},
            {"poses", poses},
            {"blades", blades_json(simulation_)}};
  if (!status.remedy.empty()) head["remedy"] = status.remedy;
  if (status.hand) head["hand"] = {{"place", status.hand->place}, {"force", status.hand->force}};
  if (!plotted_.empty()) head["plots"] = std::exchange(plotted_, {});
  if (!status.device.name.empty()) head["device"] = device_json(status.device);
  std::string message = begin_message(head, 16 * surface_.size());
  append(message, std::span<const float>(positions));
  append(message, std::span<const float>(values));
  return message;
}

}  // namespace suture
