#include "tools/reference/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nephroid::reference {

namespace {

constexpr double pi = std::numbers::pi;

// The first entry beyond a share of the last one.
std::size_t find(const std::vector<double>& sums, double share) {
    const auto at = std::upper_bound(sums.begin(), sums.end(), share * sums.back());
    return std::min(static_cast<std::size_t>(at - sums.begin()), sums.size() - 1);
}

}  // namespace

Surroundings::Surroundings(const scenes::Image& picture) {
    if (picture.linear.empty()) return;
    width_ = picture.width, height_ = picture.height;
    for (std::size_t k = 0; k < static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); ++k)
        texels_.emplace_back(picture.linear[4 * k], picture.linear[4 * k + 1], picture.linear[4 * k + 2]);
    for (int y = 0; y < height_; ++y) row_solid_angle_.push_back(2 * pi / width_ * (std::cos(pi * y / height_) - std::cos(pi * (y + 1) / height_)));
    constexpr int blocks_across = 64;
    block_ = std::max(1, (width_ + blocks_across - 1) / blocks_across);
    blocks_x_ = (width_ + block_ - 1) / block_, blocks_y_ = (height_ + block_ - 1) / block_;
    double total = 0;
    for (int b = 0; b < block_count(); ++b) {
        std::vector<double> sums;
        double sum = 0;
        for (int k = 0; k < block_ * block_; ++k) {
            const int x = b % blocks_x_ * block_ + k % block_, y = b / blocks_x_ * block_ + k / block_;
            if (x < width_ && y < height_) sum += luminance(texel(x, y)) * row_solid_angle_[static_cast<std::size_t>(y)];
            sums.push_back(sum);
        }
        texel_sum_.push_back(sums);
        block_power_.push_back(sum);
        block_sum_.push_back(total += sum);
    }
}

Rgb Surroundings::texel(int x, int y) const { return Rgb(texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)]); }

Rgb Surroundings::background(const Vec& d) const {
    if (empty()) return Rgb(0.0);
    const double x = (std::atan2(d.x, -d.z) / (2 * pi) + 0.5) * width_ - 0.5, y = std::acos(glm::clamp(d.y, -1.0, 1.0)) / pi * height_ - 0.5, fx = std::floor(x), fy = std::floor(y);
    Rgb sum(0.0);
    for (int k = 0; k < 4; ++k) {
        const int i = (static_cast<int>(fx) + (k & 1) + width_) % width_, j = std::clamp(static_cast<int>(fy) + (k >> 1), 0, height_ - 1);
        sum += texel(i, j) * ((k & 1 ? x - fx : 1 - (x - fx)) * (k >> 1 ? y - fy : 1 - (y - fy)));
    }
    return sum;
}

Surroundings::Sample Surroundings::sample_block(int block, Random& random) const {
    const std::vector<double>& sums = texel_sum_[static_cast<std::size_t>(block)];
    const std::size_t k = find(sums, random.next());
    const int x = block % blocks_x_ * block_ + static_cast<int>(k) % block_, y = block / blocks_x_ * block_ + static_cast<int>(k) / block_;
    const double phi = 2 * pi * ((x + random.next()) / width_ - 0.5), top = std::cos(pi * y / height_), bottom = std::cos(pi * (y + 1) / height_);
    const double cosine = top + (bottom - top) * random.next(), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    Sample s{{sine * std::sin(phi), cosine, -sine * std::cos(phi)}, texel(x, y), 0};
    s.per_solid_angle = luminance(s.radiance) / sums.back();
    return s;
}

Surroundings::Sample Surroundings::sample(Random& random) const {
    const std::size_t block = find(block_sum_, random.next());
    Sample s = sample_block(static_cast<int>(block), random);
    s.per_solid_angle *= block_power_[block] / block_sum_.back();
    return s;
}

}  // namespace nephroid::reference
