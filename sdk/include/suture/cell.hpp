// SPDX-License-Identifier: MIT
//
// suture/cell.hpp - what a model's functions receive: one cell, with the scalar
// type T. It stands for lanes_of<T> cells of a batch side by side, but a function is
// written as if for one.
//
//   template <class Cell> static void force(Cell& c) {
//     const auto d = c.position(1) - c.position(0);      // vec3<T>, m
//     const auto f = c.column(stiffness) * d;            // N
//     c.force(0, f);                                     // on node 0
//     c.force(1, -f);
//   }
//
// Only what the functor declares is available: reading anything else is a
// compile-time error that says what to declare.
#ifndef SUTURE_CELL_HPP
#define SUTURE_CELL_HPP

#include <stdexcept>
#include <string>
#include <utility>

#include "suture/detail/declared.hpp"
#include "suture/tensor.hpp"

namespace suture {

/// Ends a call with a status and a message. Thrown by an author's function (or by
/// stop() and retry()), caught by the layer: no exception crosses the boundary.
struct failure : std::runtime_error {
  suture_status status;
  int code = 0;  ///< the plugin's own number, shown to the user
  double step_factor = 0.5;
  int lane = -1;  ///< of the batch; -1: the whole instance
  failure(suture_status s, const std::string& text) : std::runtime_error(text), status(s) {}
};
/// Stops the run. `text` says what happened and what to do.
[[noreturn]] inline void stop(const std::string& text) { throw failure(SUTURE_STOP, text); }
/// Requests that the step be repeated with `factor` times its length.
[[noreturn]] inline void retry(const std::string& text, double factor = 0.5) {
  failure f(SUTURE_RETRY, text);
  f.step_factor = factor;
  throw f;
}

/// Parameters by place in the declared list. Authors name the places with an
/// enumeration beside the list: enum { mu, lambda, rho }; p[mu].
class values {
 public:
  explicit values(const suture_context* context) : context_(context) {}
  double operator[](int i) const { return context_->parameters[i]; }
  const suture_context* context() const { return context_; }

 private:
  const suture_context* context_;
};

/// Parameters, and the means by which prepare() reports problems with them to the user.
/// Ranges of single parameters are declared in the list and checked by the host; these
/// reports are for conditions on several parameters. `key` is a short, stable word
/// ("unstable-ratio").
class setup : public values {
 public:
  /// `cell`: the element whose parameters these are, or UINT32_MAX.
  explicit setup(const suture_context* context, std::uint32_t cell = UINT32_MAX)
      : values(context), cell_(cell) {}
  /// Shows `text` to the user once; the run continues.
  void warn(const char* key, const std::string& text) const {
    context()->host->report(context(), SUTURE_WARNING, cell_, key, text.c_str());
  }
  /// Refuses the scene.
  void refuse(const char* key, const std::string& text) const {
    context()->host->report(context(), SUTURE_ERROR, cell_, key, text.c_str());
  }

 private:
  std::uint32_t cell_;
};

/// The parameters in one cell or, with a pack R, in several side by side: some may differ from
/// element to element. `Stride`: the lanes of the columns.
template <class R, class Model, int Stride>
class element_values {
 public:
  using element = lane_type<R>;
  element_values(const suture_context* context, const element* const* columns, int lane)
      : context_(context), columns_(columns), lane_(lane) {}

  SUTURE_INLINE R operator[](int i) const {
    SUTURE_DETAIL_CHECK_INDEX(parameter, i, detail::parameter_count<Model>());
    const int place = detail::element_places<Model>[i];
    return place < 0 ? R(element(context_->parameters[i])) : load<R>(columns_[place] + lane_);
  }
  /// A parameter declared by direction().
  SUTURE_INLINE vec3<R> direction(int i) const {
    const element* const p = columns_[detail::element_places<Model>[i]] + lane_;
    return {load<R>(p), load<R>(p + Stride), load<R>(p + 2 * Stride)};
  }

 private:
  const suture_context* context_;
  const element* const* columns_;
  int lane_;
};

/// Model::Constants if the model has them, else an empty struct. A model with parameters that may
/// differ from element to element declares `template <class R> struct Constants`, an aggregate of
/// at most nine R; in a functor R is the cell's real, in prepare() double.
struct no_constants {};
template <class Model, class = void>
struct constants_of_model {
  using type = no_constants;
};
template <class Model>
struct constants_of_model<Model, std::void_t<typename Model::Constants>> {
  using type = typename Model::Constants;
};
template <class Model>
struct constants_of_model<
    Model, std::enable_if_t<sizeof(typename Model::template Constants<double>) != 0>> {
  using type = typename Model::template Constants<double>;
};
template <class Model>
using constants_of = typename constants_of_model<Model>::type;

/// The memory of an instance: what Model::prepare stores, and what the layer adds to it.
template <class Model>
struct prepared {
  constants_of<Model> constants;
  typename Model::added_constants added;
};

/// The kind of function that receives a cell: force() sets forces and trial columns,
/// inspect() examines rest shapes and reports, the others do neither.
enum class purpose { force, evaluation, inspection };

/// The batches that hold the values of a T, in double or single precision.
template <class T, class E = lane_type<real_of<T>>>
struct batch_of_scalar {
  using type = suture_batch;
  static constexpr int lanes = SUTURE_LANES;
};
template <class T>
struct batch_of_scalar<T, float> {
  using type = suture_single_batch;
  static constexpr int lanes = SUTURE_SINGLE_LANES;
};
template <class T>
using batch_of = typename batch_of_scalar<T>::type;

/// Cells `lane` .. `lane + lanes_of<T> - 1` of a batch, as one cell of scalar T.
/// With T = dual<R>, positions and velocities carry the direction (dx, dv).
template <class T, class Model, class Functor, purpose Purpose = purpose::evaluation>
class cell {
 public:
  using scalar = T;
  using real = real_of<T>;  ///< for quantities that are never differentiated

  using element = lane_type<real>;  ///< double or float

  static constexpr bool sets_forces = Purpose == purpose::force;
  /// The rest shapes for which the functor is written.
  static constexpr std::uint32_t shape = Functor::shape;

  SUTURE_INLINE cell(const suture_context* context, const batch_of<T>* batch, int lane,
                     element* force = nullptr, const element* dx = nullptr,
                     const element* dv = nullptr)
      : context_(context), batch_(batch), lane_(lane), force_(force), dx_(dx), dv_(dv) {}

  // ---- geometry and state ----
  // Nodes are numbered as in plugin.h: 0 for a vertex, 0 and 1 for an edge, 0..3 for a
  // face (its normal points outward from side 0), 0..7 for a hexahedron (X0..X7, the x
  // index runs fastest).

  /// Rest position of a node, m. Never a dual number: the rest shape does not move.
  SUTURE_INLINE vec3<real> rest(int node) const {
    static_assert(reads<SUTURE_READ_REST>,
                  "rest() is not declared: add SUTURE_READ_REST to the functor's `reads`");
    return vector<real>(batch_->rest, node);
  }
  /// Current position of a node, m. Declared by default. In rate() it is not differentiated.
  SUTURE_INLINE auto position(int node) const {
    static_assert(reads<SUTURE_READ_POSITION>,
                  "position() is not declared: add SUTURE_READ_POSITION to the functor's `reads`");
    return moving(batch_->position, dx_, node);
  }
  /// Velocity of a node, m/s. Zero if enabled() has cleared it. In rate() as position().
  SUTURE_INLINE auto velocity(int node) const {
    static_assert(reads<SUTURE_READ_VELOCITY>,
                  "velocity() is not declared: add SUTURE_READ_VELOCITY to the functor's `reads`");
    return moving(batch_->velocity, dv_, node);
  }
  /// Time of the positions, s, and length of the step in progress, s (0 outside one).
  double time() const { return batch_->time; }
  double dt() const { return batch_->dt; }

  // ---- columns ----

  /// A component of a column of this cell.
  template <std::uint32_t Place>
  SUTURE_INLINE real column(suture::column<Place>, int component = 0) const {
    SUTURE_DETAIL_CHECK_INDEX(component, component, (detail::components_of<Model, Place>()));
    return load<real>(batch_->cell_columns[cell_column<Place>()] + component * stride + lane_);
  }
  /// The same for one of several columns, chosen at run time.
  template <std::uint32_t... Places>
  SUTURE_INLINE real column(column_list<Places...>, int which, int component) const {
    constexpr int index[] = {cell_column<Places>()...};
    return load<real>(batch_->cell_columns[index[which]] + component * stride + lane_);
  }
  /// A component of a column of a node.
  template <std::uint32_t Place>
  SUTURE_INLINE real vertex_column(suture::column<Place>, int node, int component = 0) const {
    static_assert(
        !detail::is_rate_of<Functor, Place>,
        "read the field that the functor changes by field(node), which is differentiated");
    return vertex_value<Place>(node, component);
  }
  /// In rate(): the field that the functor changes (rate_of), at a node. Its vertex_columns name
  /// the field.
  SUTURE_INLINE T field(int node, int component = 0) const {
    static_assert(detail::has_rate_of<Functor>,
                  "field() is the field that the functor changes: declare `static constexpr auto "
                  "rate_of = ...`; read other fields by vertex_column()");
    return field_value(vertex_value<Functor::rate_of.place>(node, component), dx_, node, component);
  }
  /// In rate(): its change over the step, per second. Its vertex_columns name the attribute that
  /// rate_of_field() declares.
  SUTURE_INLINE T field_rate(int node, int component = 0) const {
    constexpr std::uint32_t place = detail::field_rate_place<Model>(Functor::vertex_columns.places);
    static_assert(place != UINT32_MAX,
                  "field_rate() is not declared: name the attribute of rate_of_field() in the "
                  "functor's `vertex_columns`");
    return field_value(vertex_value<place>(node, component), dv_, node, component);
  }
  /// Writes the trial copy of a column declared with trial(): the next state of a
  /// material with memory. column() keeps the accepted state until the kernel accepts
  /// the step. Has an effect only in force(), and only if T is not a dual number.
  template <std::uint32_t Place>
  SUTURE_INLINE void trial(suture::column<Place>, int component, const T& value) const {
    SUTURE_DETAIL_CHECK_INDEX(component, component, (detail::components_of<Model, Place>()));
    trial(column_list<Place>(), 0, component, value);
  }
  /// The same for one of several columns, chosen at run time.
  template <std::uint32_t... Places>
  SUTURE_INLINE void trial(column_list<Places...>, int which, int component, const T& value) const {
    static_assert((detail::has_trial<Model, Places>() && ...),
                  "trial() writes a column without a trial copy: declare its attribute with "
                  ".trial()");
    constexpr int index[] = {cell_column<Places>()...};
    if constexpr (!is_dual<T> && sets_forces)
      store(batch_->trial_columns[index[which]] + component * stride + lane_, value);
  }

  // ---- parameters ----

  /// Value of parameter `i` of the declared list: a double, or a real in a functor with
  /// `element_parameters`.
  SUTURE_INLINE auto parameter(int i) const {
    SUTURE_DETAIL_CHECK_INDEX(parameter, i, detail::parameter_count<Model>());
    if constexpr (detail::reads_element_parameters<Model, Functor>) {
      return parameters()[i];
    } else {
      if constexpr (detail::varies<Model>) {
        const bool differs = detail::element_places<Model>[i] >= 0;
        if (__builtin_constant_p(differs) && differs) detail::parameter_differs_between_elements();
      }
      return context_->parameters[i];
    }
  }
  /// All parameters, for functions that take `values` or, where they may differ from element to
  /// element, anything with p[i] and p.direction(i).
  SUTURE_INLINE auto parameters() const {
    if constexpr (detail::reads_element_parameters<Model, Functor>)
      return element_values<real, Model, stride>(context_, batch_->cell_columns, lane_);
    else
      return suture::values(context_);
  }
  /// Those that are the same in all cells.
  suture::values uniform_parameters() const { return suture::values(context_); }
  /// What Model::prepare derived from the parameters, once for the instance or once per element.
  SUTURE_INLINE decltype(auto) constants() const {
    static_assert(detail::has_prepare<Model>,
                  "constants() is not available: give the model a struct Constants and a function "
                  "`static void prepare(const suture::setup&, Constants&)`");
    if constexpr (detail::varies<Model>) {
      static_assert(detail::reads_element_constants<Model, Functor>,
                    "the parameters of this model may differ from element to element: declare "
                    "`template <class R> struct Constants`, and in the functor, which must be on "
                    "volumes, `static constexpr bool element_parameters = true`");
      return from_column<typename Model::template Constants<real>>(0);
    } else {
      return static_cast<const constants_of<Model>&>(
          static_cast<const prepared<Model>*>(context_->instance)->constants);
    }
  }
  /// What the layer between the host and the model has derived from the parameters.
  SUTURE_INLINE decltype(auto) added_constants() const {
    if constexpr (detail::varies<Model>)
      return from_column<typename Model::template added_constants_of<real>>(
          detail::leading_columns<Model, Functor> - 1);
    else
      return static_cast<const typename Model::added_constants&>(
          static_cast<const prepared<Model>*>(context_->instance)->added);
  }

  // ---- results ----

  /// Sets the force on a node, N. Every node must be set exactly once: the array is not
  /// cleared beforehand. With dual numbers the derivative is stored.
  SUTURE_INLINE void force(int node, const vec3<T>& f) const {
    static_assert(sets_forces && !detail::has_rate_of<Functor>,
                  "forces may be set only in the functor's force()");
    set(node, f);
  }

  /// Sets what flows into a node per second, in the unit of the capacity of the field times that
  /// of the field (J/K . K/s = W). Every node must be set exactly once, in every component of the
  /// field. With dual numbers the derivative is stored.
  SUTURE_INLINE void rate(int node, const T& r) const { rate(node, 0, r); }
  SUTURE_INLINE void rate(int node, int component, const T& r) const {
    static_assert(sets_forces && detail::has_rate_of<Functor>,
                  "rates may be set only in rate() of a functor with `rate_of`");
    constexpr int components =
        detail::components_of<Model, std::uint32_t(Functor::rate_of.place)>();
    SUTURE_DETAIL_CHECK_INDEX(component, component, components);
    set(node, component, r);
    for (int c = components; component == 0 && c < 3; ++c) set(node, c, T(0.0));
  }

  // ---- findings ----

  /// In inspect(): reports every cell in which `where` holds. `key` is a short, stable
  /// word, `text` one sentence that includes the remedy; the user sees each key once,
  /// with the number of cells. After a SUTURE_ERROR the scene is refused.
  template <class Mask>
  void report(suture_severity severity, const Mask& where, const char* key,
              const std::string& text) const {
    static_assert(
        Purpose == purpose::inspection,
        "cells may be reported only in the functor's inspect(); in force(), use require() or "
        "suture::stop()");
    for (int i = 0; i < lanes_of<real> && lane_ + i < int(batch_->valid); ++i)
      if (bit(where, i))
        context_->host->report(context_, severity, batch_->cell_ids[lane_ + i], key, text.c_str());
  }
  /// In force(): throws `f` for the first cell in which `good` does not hold. Costs
  /// one test per pack if it holds in all cells.
  template <class Mask>
  SUTURE_INLINE void require(const Mask& good, failure f) const {
    if (__builtin_expect(all(good), 1)) return;
    for (int i = 0; f.lane < 0; ++i)
      if (!bit(good, i)) f.lane = lane_ + i;
    throw f;
  }

 private:
  static constexpr int stride = batch_of_scalar<T>::lanes;
  template <std::uint32_t Read>
  static constexpr bool reads = (Functor::reads & Read) != 0 ||
                                (Purpose == purpose::inspection && Read != SUTURE_READ_VELOCITY);

  /// The index of the column among the declared cell_columns.
  template <std::uint32_t Place>
  static constexpr int cell_column() {
    constexpr int index = Functor::cell_columns.index_of(Place);
    static_assert(index >= 0,
                  "column() is not declared: name the column in the functor's "
                  "`cell_columns = suture::columns(...)`");
    return detail::leading_columns<Model, Functor> + index;
  }

  template <std::uint32_t Place>
  SUTURE_INLINE real vertex_value(int node, int component) const {
    constexpr int index = Functor::vertex_columns.index_of(Place);
    static_assert(index >= 0,
                  "vertex_column() is not declared: name the column in the functor's "
                  "`vertex_columns = suture::columns(...)`");
    constexpr int components = detail::components_of<Model, Place>();
    SUTURE_DETAIL_CHECK_INDEX(node, node, Functor::nodes);
    SUTURE_DETAIL_CHECK_INDEX(component, component, components);
    return load<real>(batch_->vertex_columns[index] + (node * components + component) * stride +
                      lane_);
  }
  SUTURE_INLINE void set(int node, const vec3<T>& f) const {
    for (int c = 0; c < 3; ++c) set(node, c, f[c]);
  }
  SUTURE_INLINE void set(int node, int c, const T& f) const {
    SUTURE_DETAIL_CHECK_INDEX(node, node, Functor::nodes);
    element* const p = force_ + (node * 3 + c) * stride + lane_;
    if constexpr (is_dual<T>)
      store(p, f.derivative);
    else
      store(p, f);
  }

  /// An aggregate of reals from the components of a column.
  template <class Struct>
  SUTURE_INLINE Struct from_column(int which) const {
    return from_column<Struct>(which, std::make_index_sequence<sizeof(Struct) / sizeof(real)>());
  }
  template <class Struct, std::size_t... I>
  SUTURE_INLINE Struct from_column(int which, std::index_sequence<I...>) const {
    const element* const p = batch_->cell_columns[which] + lane_;
    return Struct{load<real>(p + I * stride)...};
  }

  template <class R>
  SUTURE_INLINE vec3<R> vector(const element* p, int node) const {
    SUTURE_DETAIL_CHECK_INDEX(node, node, Functor::nodes);
    p += node * 3 * stride + lane_;
    return {load<R>(p), load<R>(p + stride), load<R>(p + 2 * stride)};
  }
  SUTURE_INLINE T field_value(const real& value, const element* direction, int node,
                              int component) const {
    if constexpr (is_dual<T>)
      return T(value, load<real>(direction + (node * 3 + component) * stride + lane_));
    else
      return value;
  }
  SUTURE_INLINE auto moving(const element* p, const element* direction, int node) const {
    if constexpr (detail::has_rate_of<Functor>) {
      return vector<real>(p, node);
    } else if constexpr (is_dual<T>) {
      const vec3<real> x = vector<real>(p, node), d = vector<real>(direction, node);
      return vec3<T>{T(x[0], d[0]), T(x[1], d[1]), T(x[2], d[2])};
    } else {
      return vector<T>(p, node);
    }
  }
  static bool bit(bool m, int) { return m; }
  template <class Mask>
  static bool bit(const Mask& m, int i) {
    return m[i];
  }

  const suture_context* context_;
  const batch_of<T>* batch_;
  int lane_;
  element* force_;
  const element* dx_;
  const element* dv_;
};

}  // namespace suture

#endif
