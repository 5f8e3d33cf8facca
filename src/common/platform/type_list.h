// Closed lists of types: the order of a list is the number of its members.
#pragma once

#include <cstddef>
#include <type_traits>

namespace pt {

template <auto value>
using Constant = std::integral_constant<decltype(value), value>;

template <class... T>
struct TypeList {
  static constexpr int size = sizeof...(T);
};

template <class... A, class... B>
TypeList<A..., B...> concatenate(TypeList<A...>, TypeList<B...>);

/// Where T stands in a list, which has it.
template <class T, class... All>
constexpr int index_in(TypeList<All...>) {
  static_assert((std::is_same_v<T, All> || ...), "the list does not have this type");
  int index = 0;
  (void)((std::is_same_v<T, All> || (++index, false)) || ...);
  return index;
}

namespace detail {
template <int index, class List>
struct Nth;
template <int index, class First, class... Rest>
struct Nth<index, TypeList<First, Rest...>> : Nth<index - 1, TypeList<Rest...>> {};
template <class First, class... Rest>
struct Nth<0, TypeList<First, Rest...>> {
  using type = First;
};
}  // namespace detail

/// The member of a list by number.
template <int index, class List>
using TypeAt = typename detail::Nth<index, List>::type;

/// Calls function(std::type_identity<T>{}) for every member.
template <class Function, class... T>
constexpr void for_each_type(TypeList<T...>, Function&& function) {
  (function(std::type_identity<T>{}), ...);
}

}  // namespace pt
