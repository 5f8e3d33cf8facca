// The commands of `ptexp`, a function each. They return the exit code and throw Error.
#pragma once

#include <string>

#include "app/options/command_line.h"
#include "common/device/devices.h"
#include "common/mpi/ranks.h"
#include "common/rays/trace_rays.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// `ptexp [options]`: renders, writes the image and reports. Refuses outputs that cannot be written
/// before any work. Returns 0, or 128 + N after signal N: image and checkpoint then have the
/// samples that were finished. The first of the `ranks` of a job prints and writes, the others work
/// for it.
int render_command(const RenderCommand& command, Ranks& ranks);

/// `ptexp resume FILE`: as render_command. The checkpoint goes on in the same file unless
/// --checkpoint names another.
int resume_command(const ResumeCommand& command, Ranks& ranks);

/// `ptexp merge OUT IN...`: writes the image that one render of all parts would have written.
/// Pixels that several files have must have the same bits, which finds a device that computes
/// wrongly. Throws Error, naming files and pixels, if they have not, if samples are missing, and
/// for files of other renders.
int merge_command(const MergeCommand& command);

/// `ptexp verify IMAGE`: renders random pixels again and compares their bits. Returns 0, or 1 if
/// any differ. Throws Error if they cannot be rendered here: another scene, no such device, no
/// header.
int verify_command(const VerifyCommand& command);

/// `ptexp compare A B`: prints how an image differs from a reference, and writes the difference if
/// a file is named (difference_image.h). Returns 0, or 1 if the largest absolute difference exceeds
/// the tolerance. FLIP is that of 8-bit images if both are, else that of radiance (flip.h).
int compare_command(const CompareCommand& command);

/// `ptexp trace`: traces a file of rays through a mesh; prints rate, tree and agreement. Returns 0,
/// or 1 if hits differ from the reference.
int trace_command(const TraceCommand& command);

/// `ptexp rays`: makes a file of rays.
int rays_command(const RaysCommand& command);

/// `ptexp compact`: checks and measures each compaction strategy in each case, beside a copy.
/// Throws Error if a strategy breaks its contract.
int compact_command(const CompactCommand& command);

/// `ptexp advise SCENE`: renders in several ways and prints which is the fastest. Returns 0, or 128
/// + N after signal N.
int advise_command(const AdviseCommand& command);

/// `ptexp calibrate`: measures the plan's constants on a device, prints them and stores them in the
/// user's cache folder. Returns as advise_command.
int calibrate_command(const CalibrateCommand& command);

/// `ptexp measure`: renders the configurations that the standard input names, a JSON object in each
/// line, and answers each with a line of the standard output: its statistics, or an error, after
/// which the next follow. What configurations have in common is kept from one to the next. Returns
/// 0 at the end of the input, or 128 + N after signal N.
int measure_command();

// The triangles of `ptexp trace` and `ptexp rays`, and rays against them on a device.

/// Throws Error for a tree, builder or variant that the device does not have.
void check_tracing(const TreeOptions& options, const TraceRuns& runs, const DeviceInfo& device);

/// Traces rays through a tree that the CPU has built.
TraceResult trace_tree(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs,
                       const DeviceInfo& device);

/// Builds the tree on the device of its builder. `options.accel` must not be automatic.
BuiltTrace build_and_trace(const SceneData& scene, const TreeOptions& options, const RaySet& rays,
                           const TraceRuns& runs, const DeviceInfo& device);

/// A .mesh file (TRBMESH1), or any scene as --scene takes it; its quads become triangles.
SceneData load_traced_scene(const std::string& name);

/// The same without its spheres. Throws Error where there are no triangles.
SceneData load_triangles(const std::string& name);

}  // namespace pt
