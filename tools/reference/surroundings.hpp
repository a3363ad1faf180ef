// The environment: radiance from far away, and directions chosen by it.
#pragma once
#include <vector>

#include "scenes/scene.hpp"
#include "tools/reference/random.hpp"
#include "tools/reference/vector.hpp"

namespace nephroid::reference {

// A lat-long picture, the first row up, the middle column along -z. As a background it is interpolated; as a light every
// texel has one radiance.
class Surroundings {
public:
    explicit Surroundings(const scenes::Image& picture);

    bool empty() const { return width_ == 0; }
    Rgb background(const Vec& direction) const;  // seen along it

    // Texels in blocks, for lights that are aimed.
    int block_count() const { return blocks_x_ * blocks_y_; }
    double block_power(int block) const { return block_power_[static_cast<std::size_t>(block)]; }  // luminance times solid angle

    struct Sample {
        Vec towards;          // unit direction to where the light comes from
        Rgb radiance;
        double per_solid_angle;  // density of the choice, 1/sr
    };
    Sample sample_block(int block, Random& random) const;
    // From the whole sphere.
    Sample sample(Random& random) const;

private:
    Rgb texel(int x, int y) const;
    int width_ = 0, height_ = 0, blocks_x_ = 0, blocks_y_ = 0, block_ = 1;
    std::vector<glm::vec3> texels_;
    std::vector<double> block_power_, block_sum_;     // and the sums up to each block's end
    std::vector<std::vector<double>> texel_sum_;      // of each block, up to each texel's end
    std::vector<double> row_solid_angle_;
};

}  // namespace nephroid::reference
