// Scene files of all formats.
//
// A format is a folder: its syntax, and tables from the names of types to functions that read one.
// What formats share is in `files`: importer.h (values with textures, maps, cameras), text.h
// (words, numbers, warnings of a kind as one), whole_file.h (files by name),
// images/texture_store.h, meshes/mesh_files.h, meshes/vertex_colors.h, volumes/volume_files.h,
// spectra.h and default_lighting.h (light for files without). In: a path and LoadOptions. Out:
// SceneData, and what was replaced or left out as lines to LoadOptions::report. One bad element
// loses itself, not the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// Loads a scene; the ending of the name, in either case, says which format it has: .xml (Mitsuba),
/// .gltf, .glb, .pbrt (pbrt-v4), .obj or .ply. The last two have neither camera nor lights: they
/// get a camera that frames them, and models that their own light does not show default lighting
/// (default_lighting.h); `options.warn` is told so. A .ply is grey, diffuse. Throws Error for other
/// endings and as the formats' loaders do.
SceneData load_scene_file(const std::filesystem::path& path, const LoadOptions& options = {});

// Scenes in Mitsuba's XML, dialects 0.5, 0.6, 2 and 3.

/// Loads a scene and the meshes, textures and environment that it names. What we cannot do is
/// replaced by the nearest that we can, or left out, and reported through the options, once for
/// each kind. Throws Error, one line with file and line, for a file that is malformed or missing.
SceneData load_mitsuba_xml(const std::filesystem::path& path, const LoadOptions& options = {});

/// The same of a file's text. Files lie beside the current folder; errors call it <string>.
SceneData load_mitsuba_text(std::string_view text, const LoadOptions& options);

namespace mitsuba {
struct Element;
}

/// The same of a <scene> that somebody has made in memory.
SceneData load_mitsuba_scene(const mitsuba::Element& root, const std::string& name,
                             const LoadOptions& options);

// Scenes in glTF 2.0 (Khronos, 'glTF 2.0 Specification', version 2.0.1), .gltf and .glb.

/// The default scene of the file (its first one where it names none). A mesh that one node uses is
/// put into world space, one that several use becomes a group and instances. Lights' candela, lux
/// and nits are taken as W/sr, W/m^2 and W/(m^2 sr). A scene without a camera gets one that frames
/// it, one that its own light does not show default lighting; `options.warn` is told so.
///
/// Meshes have the shape of their default weights, and skins that of their nodes. What has no
/// counterpart here is replaced by the nearest that has, and reported once a kind: what the
/// principled BSDF has otherwise, colours of vertices beside textures by their mean. Ignored:
/// points and lines, animations. A value or an element that cannot be used is left out, with a
/// warning.
///
/// Throws Error, one line with the file and the object's place in it
/// (meshes[3].primitives[0].attributes.POSITION), for a file that is missing, whose structure is
/// malformed or that needs an extension that we lack.
SceneData load_gltf(const std::filesystem::path& path, const LoadOptions& options);

// Scenes in pbrt-v4's format.

/// Loads a scene and the meshes, textures and pictures that it names. What we cannot do is replaced
/// by the nearest that we can, or left out, and reported through the options, once for each kind.
/// Throws Error, one line with file, line and column, for a file that is malformed or missing.
SceneData load_pbrt(const std::filesystem::path& path, const LoadOptions& options = {});

// Wavefront OBJ files with the materials of their MTL files.

/// The meshes, one for each material in use, and these materials; neither camera nor light but
/// what the materials emit. What a file names that is missing or wrong is left out, with a warning
/// of each kind. Throws Error for a file that cannot be read.
SceneData load_obj(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace pt
