// nephroid plan: the passes that a scene's picture takes, and why.
#include <cstdio>
#include <memory>

#include "stages/frame_plan.hpp"
#include "tools/commands.hpp"
#include "tools/joined.hpp"
#include "tools/render_options.hpp"
#include "tools/world_builder.hpp"

namespace nephroid {

namespace {

void run(RenderOptions& options) {
    Device device({.threads = options.threads, .lanes = options.lanes});
    const scenes::Scene scene = load_scene(options);
    options.finish(scene);
    say_notes(scene.notes);
    const BuiltWorld built = build_world(device, scene);
    say_notes(built.notes);
    const stages::FramePlan plan = stages::make_plan(built.world, options.settings);
    std::printf("%zu passes:\n", plan.passes.size());
    for (const stages::Pass& p : plan.passes) {
        std::printf("  %-52s %s\n", p.name.c_str(), p.why.c_str());
        if (!p.reads.empty()) std::printf("      reads   %s\n", joined(p.reads).c_str());
        std::printf("      writes  %s\n", joined(p.writes).c_str());
    }
    std::printf("left out:%s\n", plan.left_out.empty() ? " nothing" : "");
    for (const stages::FramePlan::LeftOut& l : plan.left_out) std::printf("  %-52s %s\n", l.what.c_str(), l.why.c_str());
}

}  // namespace

void add_plan_command(CLI::App& app) {
    const auto options = std::make_shared<RenderOptions>();
    CLI::App* c = app.add_subcommand("plan", "Print the passes that a scene's picture takes, why each is there, and what is left out");
    options->add_to(*c);
    c->callback([options] { run(*options); });
}

}  // namespace nephroid
