// Roundings that compilers keep: of a product on its own, whatever the flags say about fused multiply-add,
// and of a wide number to a narrower type.
//
// Problem of products: g++ contracts a*b - c*d to fma(a, b, -(c*d)) wherever the target has FMA. The two
// products are then rounded differently, so the edge function of an edge seen from its two triangles no
// longer changes sign only, and rays slip through. There is no portable pragma that g++ obeys, and flags
// belong to the user of a header. Cure: pass the product through an empty asm statement: no instruction, but
// nothing to contract either. Cost: none in scalar code; it keeps the compiler from vectorising the
// expression. Elsewhere: a store and a load.
#pragma once

namespace treeline::geometry {

template <class T>
inline T rounded(T x) {
#if (defined(__GNUC__) || defined(__clang__)) && defined(__SSE2__)
  asm("" : "+x"(x));
  return x;
#elif (defined(__GNUC__) || defined(__clang__)) && defined(__aarch64__)
  asm("" : "+w"(x));
  return x;
#else
  volatile T stored = x;
  return stored;
#endif
}

/// x rounded to the narrower type N, and as wide as before: what a float would hold, in a double.
/// Problem: GCC 12 drops the conversion there and back in some loops that it vectorises at -O3, and leaves x
/// as it was. Cure and cost as above.
template <class N, class W>
inline W rounded_to(W x) {
  return static_cast<W>(rounded(static_cast<N>(x)));
}

/// A number whose products are rounded on their own: what a kernel over any number type computes with it,
/// vectors of such numbers compute lane by lane, bit for bit.
template <class T>
struct Rounded {
  T value;

  friend Rounded operator+(Rounded a, Rounded b) { return {a.value + b.value}; }
  friend Rounded operator-(Rounded a, Rounded b) { return {a.value - b.value}; }
  friend Rounded operator*(Rounded a, Rounded b) { return {rounded(a.value * b.value)}; }
  friend Rounded operator/(Rounded a, Rounded b) { return {a.value / b.value}; }
};

}  // namespace treeline::geometry
