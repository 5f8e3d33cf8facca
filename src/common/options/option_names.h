// The one place where an enumerator of options.h has a name: the command line, the reports and
// every error message read these tables.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "common/options/options.h"
#include "common/options/stats.h"

namespace pt {

template <typename E>
struct EnumName {
  E value;
  std::string_view name;
};

/// Every enumerator of E with its name, in the order of declaration.
template <typename E>
inline constexpr std::array<EnumName<E>, 0> enum_names{};

template <>
inline constexpr auto enum_names<Mode> =
    std::to_array<EnumName<Mode>>({{Mode::automatic, "auto"},
                                   {Mode::serial, "serial"},
                                   {Mode::megakernel, "megakernel"},
                                   {Mode::wavefront, "wavefront"}});
template <>
inline constexpr auto enum_names<IntegratorKind> = std::to_array<EnumName<IntegratorKind>>(
    {{IntegratorKind::path, "path"}, {IntegratorKind::mlt, "mlt"}});
template <>
inline constexpr auto enum_names<Work> = std::to_array<EnumName<Work>>(
    {{Work::pixel, "pixel"}, {Work::sample, "sample"}, {Work::persistent, "persistent"}});
template <>
inline constexpr auto enum_names<KernelSet> =
    std::to_array<EnumName<KernelSet>>({{KernelSet::automatic, "auto"},
                                        {KernelSet::specialized, "lean"},
                                        {KernelSet::general, "general"}});
template <>
inline constexpr auto enum_names<MegakernelKind> =
    std::to_array<EnumName<MegakernelKind>>({{MegakernelKind::automatic, "auto"},
                                             {MegakernelKind::loop, "loop"},
                                             {MegakernelKind::vote, "vote"},
                                             {MegakernelKind::sort, "sort"}});
template <>
inline constexpr auto enum_names<Compaction> = [] {
  std::array<EnumName<Compaction>, std::size(compaction_table)> names{};
  for (std::size_t i = 0; i < names.size(); ++i) {
    names[i] = {compaction_table[i].id, compaction_table[i].name};
  }
  return names;
}();
template <>
inline constexpr auto enum_names<Schedule> = std::to_array<EnumName<Schedule>>(
    {{Schedule::automatic, "auto"}, {Schedule::host, "host"}, {Schedule::graph, "graph"}});
template <>
inline constexpr auto enum_names<PoolLayout> = std::to_array<EnumName<PoolLayout>>(
    {{PoolLayout::soa, "soa"}, {PoolLayout::sectors, "sectors"}, {PoolLayout::aos, "aos"}});
template <>
inline constexpr auto enum_names<SurfaceOrdering> =
    std::to_array<EnumName<SurfaceOrdering>>({{SurfaceOrdering::automatic, "auto"},
                                              {SurfaceOrdering::on, "on"},
                                              {SurfaceOrdering::off, "off"}});
template <>
inline constexpr auto enum_names<Stages> = std::to_array<EnumName<Stages>>(
    {{Stages::automatic, "auto"}, {Stages::split, "split"}, {Stages::fused, "fused"}});
template <>
inline constexpr auto enum_names<SceneMemory> =
    std::to_array<EnumName<SceneMemory>>({{SceneMemory::automatic, "auto"},
                                          {SceneMemory::global, "global"},
                                          {SceneMemory::shared, "shared"},
                                          {SceneMemory::constant, "constant"}});
template <>
inline constexpr auto enum_names<Branching> = std::to_array<EnumName<Branching>>(
    {{Branching::divergent, "divergent"}, {Branching::reduced, "reduced"}});
template <>
inline constexpr auto enum_names<RngKind> =
    std::to_array<EnumName<RngKind>>({{RngKind::philox, "philox"}, {RngKind::xorwow, "xorwow"}});
template <>
inline constexpr auto enum_names<SamplerKind> =
    std::to_array<EnumName<SamplerKind>>({{SamplerKind::independent, "independent"},
                                          {SamplerKind::stratified, "stratified"},
                                          {SamplerKind::sobol, "sobol"}});
template <>
inline constexpr auto enum_names<DirectionSampling> =
    std::to_array<EnumName<DirectionSampling>>({{DirectionSampling::uniform, "uniform"},
                                                {DirectionSampling::cosine, "cosine"},
                                                {DirectionSampling::bsdf, "bsdf"}});
template <>
inline constexpr auto enum_names<MisHeuristic> =
    std::to_array<EnumName<MisHeuristic>>({{MisHeuristic::none, "none"},
                                           {MisHeuristic::balance, "balance"},
                                           {MisHeuristic::power, "power"}});
#define PT_ACCEL_NAME(name) {AccelKind::name, #name},
template <>
inline constexpr auto enum_names<AccelKind> = std::to_array<EnumName<AccelKind>>(
    {{AccelKind::automatic, "auto"}, PT_ACCELS(PT_ACCEL_NAME){AccelKind::optix, "optix"}});
#undef PT_ACCEL_NAME
template <>
inline constexpr auto enum_names<OptixHits> =
    std::to_array<EnumName<OptixHits>>({{OptixHits::custom, "custom"},
                                        {OptixHits::any_hit, "any-hit"},
                                        {OptixHits::built_in, "built-in"}});
template <>
inline constexpr auto enum_names<TreeBuilder> =
    std::to_array<EnumName<TreeBuilder>>({{TreeBuilder::automatic, "auto"},
                                          {TreeBuilder::sah, "sah"},
                                          {TreeBuilder::sah_reinsert, "sah-reinsert"},
                                          {TreeBuilder::sbvh, "sbvh"},
                                          {TreeBuilder::best, "best"},
                                          {TreeBuilder::lbvh, "lbvh"},
                                          {TreeBuilder::hploc, "hploc"},
                                          {TreeBuilder::hploc_reinsert, "hploc-reinsert"}});
template <>
inline constexpr auto enum_names<LightSelection> =
    std::to_array<EnumName<LightSelection>>({{LightSelection::automatic, "auto"},
                                             {LightSelection::uniform, "uniform"},
                                             {LightSelection::power, "power"},
                                             {LightSelection::tree, "tree"}});
template <>
inline constexpr auto enum_names<FilterKind> =
    std::to_array<EnumName<FilterKind>>({{FilterKind::box, "box"},
                                         {FilterKind::tent, "tent"},
                                         {FilterKind::gaussian, "gaussian"},
                                         {FilterKind::mitchell, "mitchell"},
                                         {FilterKind::lanczos, "lanczos"}});
template <>
inline constexpr auto enum_names<RunEnd> =
    std::to_array<EnumName<RunEnd>>({{RunEnd::samples, "samples"},
                                     {RunEnd::time_limit, "time_limit"},
                                     {RunEnd::target_error, "target_error"},
                                     {RunEnd::interrupted, "interrupted"}});
template <>
inline constexpr auto enum_names<WorldBuilder> = std::to_array<EnumName<WorldBuilder>>(
    {{WorldBuilder::host, "host"}, {WorldBuilder::device, "device"}});
template <>
inline constexpr auto enum_names<VolumeStorage> =
    std::to_array<EnumName<VolumeStorage>>({{VolumeStorage::automatic, "auto"},
                                            {VolumeStorage::dense, "dense"},
                                            {VolumeStorage::sparse, "sparse"}});
template <>
inline constexpr auto enum_names<DefaultLighting> =
    std::to_array<EnumName<DefaultLighting>>({{DefaultLighting::automatic, "auto"},
                                              {DefaultLighting::on, "on"},
                                              {DefaultLighting::off, "off"}});
/// The stages that --stage-block has.
template <>
inline constexpr auto enum_names<StageId> = [] {
  constexpr auto count = std::ranges::count(stage_table, true, &StageInfo::has_block);
  std::array<EnumName<StageId>, count> names{};
  std::size_t i = 0;
  for (const StageInfo& stage : stage_table) {
    if (stage.has_block) names[i++] = {stage.id, stage.name};
  }
  return names;
}();

/// Names of the release before, which the command line still takes.
template <typename E>
inline constexpr std::array<EnumName<E>, 0> old_enum_names{};
template <>
inline constexpr auto old_enum_names<StageId> =
    std::to_array<EnumName<StageId>>({{StageId::route_hits, "sort_hits"}});

template <>
inline constexpr auto enum_names<DeviceChoice::Kind> =
    std::to_array<EnumName<DeviceChoice::Kind>>({{DeviceChoice::Kind::automatic, "auto"},
                                                 {DeviceChoice::Kind::cpu, "cpu"},
                                                 {DeviceChoice::Kind::cuda, "cuda"}});

/// An enumeration with a table above.
template <typename E>
concept NamedEnum = !enum_names<E>.empty();

/// The name that the command line uses, e.g. "auto" for Schedule::automatic.
template <NamedEnum E>
std::string to_string(E value) {
  for (const EnumName<E>& entry : enum_names<E>)
    if (entry.value == value) return std::string(entry.name);
  return "?";  // only a cast can make a value without a name
}

/// "auto", "cpu", "cpu:N" of N devices, "cuda:N", "cuda:N,M" or "cuda:all".
inline std::string to_string(const DeviceChoice& device) {
  std::string text = to_string(device.kind);
  if (device.kind == DeviceChoice::Kind::cpu) {
    return device.more.empty() ? text : text + ':' + std::to_string(device.count());
  }
  if (device.kind == DeviceChoice::Kind::automatic) return text;
  if (device.wants_all) return text + ":all";
  text += ':' + std::to_string(device.index);
  for (const int index : device.more) text += ',' + std::to_string(index);
  return text;
}

/// The names joined, e.g. "serial|megakernel|wavefront".
template <NamedEnum E>
std::string joined_names(std::string_view separator) {
  std::string text;
  for (const EnumName<E>& entry : enum_names<E>)
    text.append(text.empty() ? "" : separator).append(entry.name);
  return text;
}

}  // namespace pt
