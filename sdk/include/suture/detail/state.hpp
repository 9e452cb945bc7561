// SPDX-License-Identifier: MIT
//
// suture/detail/state.hpp - the state of a law at the Gauss points, and the fields that it reads
// there: their columns, and how they get from them to the law and back. Authors need not read it.
#ifndef SUTURE_DETAIL_STATE_HPP
#define SUTURE_DETAIL_STATE_HPP

#include <utility>

#include "suture/hexahedron_gradients.hpp"
#include "suture/model.hpp"

namespace suture {

/// A part of the state of a law: `n` numbers per Gauss point, which start from 0 or starts_at().
constexpr attribute state(const char* name, const char* unit, const char* doc, int n = 1) {
  return volume_attribute(name, unit, doc, n).copy().trial().internal();
}

/// What a law receives besides F and p. `state`: the model's State<T>, at the end of the step
/// (in evolve() at first: at its beginning). `time` and `dt`, s, as those of a cell. `field`: the
/// values of the model's vertex_fields at the point, component by component.
template <class State, class R = double, std::size_t Fields = 0>
struct instant {
  State state;
  double time, dt;
  R field[Fields];
};
template <class State, class R>
struct instant<State, R, 0> {
  State state;
  double time, dt;
};

/// What a law releases into its field, per rest volume and second, and the flow of the field
/// through a rest area, per second: C du/dt = source - div flow.
template <class T>
struct released {
  T source;
  vec3<T> flow;
};
template <class T>
released(T, vec3<T>) -> released<T>;

/// What release() receives besides F and p, at a Gauss point.
template <class T>
struct field_point {
  using R = real_of<T>;
  T field;            ///< its value u
  vec3<T> gradient;   ///< grad u in the shape at rest
  T rate, mean_rate;  ///< du/dt in the step, and its mean over the element's points; 0 unless
                      ///< vertex_fields declares a rate_of_field()
  mat3<R> dF;         ///< dF/dt, likewise
  double time, dt;    ///< as those of a cell
};

namespace detail {

struct no_state {};
template <class M, class T, class = void>
struct state_of_model {
  using type = no_state;
};
template <class M, class T>
struct state_of_model<M, T, std::void_t<typename M::template State<T>>> {
  using type = typename M::template State<T>;
};
template <class M, class T>
using state_of = typename state_of_model<M, T>::type;
template <class M>
inline constexpr bool has_state = !std::is_same_v<state_of<M, double>, no_state>;
/// The attributes that `vertex_fields` declares; the fields come first.
template <class M>
constexpr std::size_t field_attribute_count() {
  if constexpr (has_vertex_fields<M>)
    return std::size(M::vertex_fields);
  else
    return 0;
}
template <class M>
constexpr std::size_t field_count() {
  std::size_t count = 0;
  if constexpr (has_vertex_fields<M>)
    for (const auto& a : M::vertex_fields) count += (a.flags & SUTURE_FIELD) != 0;
  return count;
}
/// The components of all fields.
template <class M>
constexpr std::size_t field_components() {
  std::size_t sum = 0;
  if constexpr (has_vertex_fields<M>)
    for (std::size_t i = 0; i < field_count<M>(); ++i) sum += M::vertex_fields[i].components;
  return sum;
}
template <class M, class T>
using instant_of = instant<state_of<M, T>, real_of<T>, field_components<M>()>;

template <class M>
constexpr std::size_t state_count() {
  if constexpr (has_states<M>)
    return std::size(M::states);
  else
    return 0;
}
/// The numbers in the first `parts` of a state.
template <class M>
constexpr int state_components([[maybe_unused]] std::size_t parts = state_count<M>()) {
  std::uint32_t sum = 0;
  if constexpr (has_states<M>)
    for (std::size_t i = 0; i < parts; ++i) sum += M::states[i].components;
  return int(sum);
}

/// "viscous_strain_3": part `State` at Gauss point `Point`.
template <class M, std::size_t State, int Point>
struct name_of_state {
  static constexpr auto make() {
    constexpr std::string_view name = M::states[State].name;
    std::array<char, name.size() + 3> text{};
    for (std::size_t i = 0; i < name.size(); ++i) text[i] = name[i];
    text[name.size()] = '_';
    text[name.size() + 1] = char('0' + Point);
    return text;
  }
  static constexpr auto text = make();
};

template <class M, std::size_t I>
constexpr attribute state_attribute() {
  attribute a = M::states[I / 8];
  a.name = name_of_state<M, I / 8, int(I % 8)>::text.data();
  return a;
}
/// An attribute per part and Gauss point, 8 for each part, then those of fields.
template <class M, std::size_t... I, std::size_t... Field>
constexpr std::array<attribute, sizeof...(I) + sizeof...(Field)> attributes_of_law(
    std::index_sequence<I...>, std::index_sequence<Field...>) {
  return {state_attribute<M, I>()..., attribute(M::vertex_fields[Field])...};
}
template <class M>
constexpr auto attributes_of_law() {
  return attributes_of_law<M>(std::make_index_sequence<state_count<M>() * 8>(),
                              std::make_index_sequence<field_attribute_count<M>()>());
}

template <class M, std::size_t... Field>
constexpr auto field_columns_of(std::index_sequence<Field...>)
    -> column_list<std::uint32_t(first_added_attribute<M> + state_count<M>() * 8 + Field)...> {
  return {};
}
/// The vertex columns of the fields that a law reads.
template <class M>
inline constexpr auto field_columns =
    field_columns_of<M>(std::make_index_sequence<field_count<M>()>());

/// The columns of an element with 1, 6 or 8 points: those of a part are neighbours.
template <class M, int Points, std::size_t... I>
constexpr auto state_columns_at(std::index_sequence<I...>)
    -> column_list<std::uint32_t(first_added_attribute<M> + I / Points * 8 + I % Points)...> {
  return {};
}
template <class M, int Points>
inline constexpr auto state_columns =
    state_columns_at<M, Points>(std::make_index_sequence<state_count<M>() * Points>());

/// Calls visit(part, component, number) for each number of a state, without a loop over its parts:
/// what depends on the part is constant.
template <class M, std::size_t Part, class Visit>
SUTURE_INLINE void for_part(Visit&& visit) {
  constexpr int count = int(M::states[Part].components), first = state_components<M>(Part);
  for (int i = 0; i < count; ++i) visit(int(Part), i, first + i);
}
template <class M, class Visit, std::size_t... Parts>
SUTURE_INLINE void for_parts(Visit&& visit, std::index_sequence<Parts...>) {
  (for_part<M, Parts>(visit), ...);
}
template <class M, class Visit>
SUTURE_INLINE void for_state(Visit&& visit) {
  for_parts<M>(visit, std::make_index_sequence<state_count<M>()>());
}

/// The numbers of a state, in the order of its parts: an aggregate of nothing else.
template <class T, class State>
SUTURE_INLINE T* numbers_of(State& state) {
  return reinterpret_cast<T*>(&state);
}
template <class T, class State>
SUTURE_INLINE const T* numbers_of(const State& state) {
  return reinterpret_cast<const T*>(&state);
}

/// The state with which elements start.
template <class M, class T>
instant_of<M, T> first_instant() {
  instant_of<M, T> at{};
  if constexpr (has_state<M>)
    for_state<M>([numbers = numbers_of<T>(at.state)](int part, int, int number) {
      numbers[number] = M::states[part].initial;
    });
  if constexpr (has_vertex_fields<M>)
    for (std::size_t i = 0, number = 0; i < field_count<M>(); ++i)
      for (std::size_t c = 0; c < M::vertex_fields[i].components; ++c)
        at.field[number++] = M::vertex_fields[i].initial;
  return at;
}

/// N_n at a Gauss point of an element with 8, at the centre of one with 1, at the centre of a face
/// of one with 6 (bending_samples.hpp).
template <int Points>
constexpr double node_weight(int point, int n) {
  if (Points == 6) return (n >> point / 2 & 1) == point % 2 ? 0.25 : 0.0;
  double weight = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_near = (point >> axis & 1) == (n >> axis & 1);
    weight *= Points == 1 ? 0.5 : is_near ? 1 - gauss<2>::first : gauss<2>::first;
  }
  return weight;
}
template <class M, int Points, class Cell, std::uint32_t... Places, class R, std::size_t Fields>
SUTURE_INLINE void interpolate_fields(const Cell& c, int point, column_list<Places...>,
                                      R (&field)[Fields]) {
  std::size_t number = 0;
  const auto one = [&](auto place) SUTURE_DETAIL_INLINED {
    for (int i = 0; i < components_of<M, decltype(place)::place>(); ++i) {
      R sum(0.0);
      for (int n = 0; n < 8; ++n)
        sum += node_weight<Points>(point, n) * c.vertex_column(place, n, i);
      field[number++] = sum;
    }
  };
  (one(column<Places>()), ...);
}

/// The accepted state at a Gauss point of an element with `Points`, and the fields there.
template <class M, int Points, class Cell>
SUTURE_INLINE instant_of<M, typename Cell::scalar> accepted_instant(const Cell& c, int point) {
  using T = typename Cell::scalar;
  instant_of<M, T> at;
  at.time = c.time();
  at.dt = c.dt();
  if constexpr (has_state<M>)
    for_state<M>([&](int part, int i, int number) SUTURE_DETAIL_INLINED {
      numbers_of<T>(at.state)[number] =
          c.column(state_columns<M, Points>, part * Points + point, i);
    });
  if constexpr (has_vertex_fields<M>)
    interpolate_fields<M, Points>(c, point, field_columns<M>, at.field);
  return at;
}

/// Writes the trial copy of the state.
template <class M, int Points, class Cell, class At>
SUTURE_INLINE void keep_state([[maybe_unused]] const Cell& c, [[maybe_unused]] int point,
                              [[maybe_unused]] const At& at) {
  if constexpr (has_state<M>) {
    for_state<M>([&](int part, int i, int number) SUTURE_DETAIL_INLINED {
      c.trial(state_columns<M, Points>, part * Points + point, i,
              numbers_of<typename Cell::scalar>(at.state)[number]);
    });
  }
}

}  // namespace detail
}  // namespace suture

#endif
