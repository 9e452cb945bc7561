// SPDX-License-Identifier: MIT
//
// suture/detail/tape.hpp - what reverse.hpp notes while it evaluates a function, and how it reads
// its notes backwards. Authors need not read it.
#ifndef SUTURE_DETAIL_TAPE_HPP
#define SUTURE_DETAIL_TAPE_HPP

#include "suture/tensor.hpp"

namespace suture::detail {

/// How the adjoint of an operand follows from that of the result.
enum class influence {
  none,
  same,
  opposite,
  scaled,    ///< times a real
  weighted,  ///< times a number that is finite where the operand is
  squared,   ///< twice times that number: the square of the operand
  singular   ///< times a number that may be infinite
};

/// The operations of a function in their order, after its inputs: per operand a code of its
/// place and influence, and the derivative of the result by it. Arrays of numbers, not of structs:
/// the compiler then follows each store to its only load.
template <class T>
struct tape {
  static constexpr int capacity = 160;  // Mooney-Rivlin takes 128
  int operand[2][capacity];             ///< 16 place + 2 influence + selected; 0: none
  T weight[2][capacity];
  int size;
};

/// An operand's part in a result: `weight` is a T, or no_weight in sums.
template <class T, class Weight>
struct relation {
  tape<T>* notes;
  int operand;  ///< as in a tape
  Weight weight;
};
struct no_weight {};
template <class T>
SUTURE_INLINE relation<T, no_weight> no_relation() {
  return {nullptr, 0, {}};
}
template <class T>
SUTURE_INLINE void keep(T& place, const T& weight) {
  place = weight;
}
template <class T>
SUTURE_INLINE void keep(T&, no_weight) {}

/// Notes an operation and returns its place.
template <class T, class A, class B>
SUTURE_INLINE int note(tape<T>& notes, const relation<T, A>& a, const relation<T, B>& b) {
  const int place = notes.size++;
  if (place >= tape<T>::capacity) return place;
  notes.operand[0][place] = a.operand;
  keep(notes.weight[0][place], a.weight);
  notes.operand[1][place] = b.operand;
  keep(notes.weight[1][place], b.weight);
  return place;
}

/// Whether a derivative is zero, whatever it is multiplied by.
template <class T>
SUTURE_INLINE auto vanishes(const T& a) {
  return a == 0.0;
}
template <class T>
SUTURE_INLINE auto vanishes(const dual<T>& a) {
  return vanishes(a.value) & vanishes(a.derivative);
}

/// dW by the results on a tape.
template <class T>
struct adjoints {
  T value[tape<T>::capacity];
  int state[tape<T>::capacity] = {};  ///< 0: none; 1, or 2 and 3 if something was selected

  SUTURE_INLINE void add(int place, const T& a, int is_selected) {
    value[place] = state[place] ? value[place] + a : a;
    state[place] |= 1 + is_selected;
  }
  SUTURE_INLINE void pass_on(int place, const tape<T>& notes, int n) {
    const int code = notes.operand[n][place], to = code / 16, kind = code / 2 % 8;
    if (code == 0) return;
    const T &a = value[place], &weight = notes.weight[n][place];
    const int is_selected = (state[place] & 2) | (2 * (code & 1));
    add(to, share(a, weight, kind, is_selected), is_selected);
  }
  /// What an operand receives of the adjoint `a` of a result. add() is called once for all kinds:
  /// it is inlined 300 times before the compiler knows which kind is which.
  static SUTURE_INLINE T share(const T& a, const T& weight, int kind, int is_selected) {
    if (kind == int(influence::same)) return a;
    if (kind == int(influence::opposite)) return -a;
    if (kind == int(influence::scaled)) return a * real(weight);
    // a + a is the same for all terms of a sum.
    if (kind == int(influence::squared)) return (a + a) * weight;
    const T product = a * weight;
    if (kind == int(influence::weighted) || !is_selected) return product;
    // What select() did not take may have an infinite derivative, such as that of log(0).
    return select(vanishes(a), T(0.0), product);
  }
  SUTURE_INLINE void pass_on(int place, const tape<T>& notes) {
    if (state[place] == 0) return;
    pass_on(place, notes, 0);
    pass_on(place, notes, 1);
  }
};

/// dW/dF by nine directional derivatives. Not inlined, so that it is not compiled where the
/// tape is used.
template <class T, class Function>
[[gnu::noinline]] mat3<T> gradient_by_duals(const mat3<T>& F, Function&& W) {
  mat3<T> P;
  mat3<dual<T>> G;
  for (int i = 0; i < 9; ++i) G(i / 3, i % 3) = F(i / 3, i % 3);
  SUTURE_DETAIL_ROLLED
  for (int i = 0; i < 9; ++i) {
    G(i / 3, i % 3).derivative = 1.0;
    P(i / 3, i % 3) = dual<T>(W(G)).derivative;
    G(i / 3, i % 3).derivative = 0.0;
  }
  return P;
}

}  // namespace suture::detail

#endif
