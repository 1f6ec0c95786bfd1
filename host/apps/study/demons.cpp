// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/demons.hpp"

#include <itkDiffeomorphicDemonsRegistrationFilter.h>
#include <itkDiscreteGaussianImageFilter.h>
#include <itkImage.h>
#include <itkMultiResolutionPDEDeformableRegistration.h>

#include <array>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using GreyImage = itk::Image<float, 3>;
using Field = itk::Image<itk::Vector<float, 3>, 3>;

/// Grey values by label of the pelvis: surrounding tissue, prostate, bladder, rectum, bones; no two
/// alike, and neighbours far apart.
float grey_value(std::uint16_t label) {
    static constexpr std::array<float, 6> values{50, 120, 190, 0, 250, 250};
    return values[label % values.size()];
}

GreyImage::Pointer grey_image(const LabelImage& labels, double smoothing_mm) {
    auto image = GreyImage::New();
    GreyImage::SizeType size;
    GreyImage::DirectionType direction;
    for (unsigned axis = 0; axis < 3; ++axis) {
        size[axis] = itk::SizeValueType(labels.grid.size[axis]);
        for (unsigned row = 0; row < 3; ++row)
            direction(row, axis) = labels.grid.direction(row, axis);
    }
    image->SetRegions(size);
    image->SetOrigin(labels.grid.origin.data());
    image->SetSpacing(labels.grid.spacing.data());
    image->SetDirection(direction);
    image->Allocate();
    for (std::size_t v = 0; v < labels.voxels.size(); ++v)
        image->GetBufferPointer()[v] = grey_value(labels.voxels[v]);

    auto smoothing = itk::DiscreteGaussianImageFilter<GreyImage, GreyImage>::New();
    smoothing->SetInput(image);
    smoothing->SetVariance(smoothing_mm * smoothing_mm);  // mm^2: the image's spacing is used
    smoothing->Update();
    return smoothing->GetOutput();
}

Image<Vec3> to_image(const Field& field, const ImageGrid& grid) {
    Image<Vec3> image{grid, std::vector<Vec3>(grid.num_voxels())};
    for (std::size_t v = 0; v < image.voxels.size(); ++v) {
        const auto& u = field.GetBufferPointer()[v];
        image.voxels[v] = Vec3(u[0], u[1], u[2]);
    }
    return image;
}

}  // namespace

Image<Vec3> demons_displacement(const LabelImage& reference, const LabelImage& target,
                                const DemonsOptions& options) {
    using Demons = itk::DiffeomorphicDemonsRegistrationFilter<GreyImage, GreyImage, Field>;
    using Pyramid = itk::MultiResolutionPDEDeformableRegistration<GreyImage, GreyImage, Field>;
    try {
        auto demons = Demons::New();
        demons->SetStandardDeviations(options.field_smoothing_voxels);
        auto pyramid = Pyramid::New();
        pyramid->SetRegistrationFilter(demons);
        pyramid->SetFixedImage(grey_image(reference, options.label_smoothing_mm));
        pyramid->SetMovingImage(grey_image(target, options.label_smoothing_mm));
        pyramid->SetNumberOfLevels(unsigned(options.levels));
        Pyramid::NumberOfIterationsType iterations(unsigned(options.levels));
        iterations.Fill(unsigned(options.iterations));
        pyramid->SetNumberOfIterations(iterations);
        pyramid->Update();
        return to_image(*pyramid->GetOutput(), reference.grid);
    } catch (const itk::ExceptionObject& error) {
        throw Error(ErrorCode::internal,
                    std::string("The demons registration failed: ") + error.GetDescription() + ".");
    }
}

}  // namespace palpate
