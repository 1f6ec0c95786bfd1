// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solver/backend/device_vector.hpp"
#include "solver/model/model.hpp"

namespace palpate {

enum class Precision { single, double_ };

/// How the stiffness product is computed: element by element, or from a 3x3 block CSR matrix.
enum class Product { matrix_free, assembled };

struct BackendOptions {
    Precision precision = Precision::single;  ///< of vectors and products on the device
    Product product = Product::assembled;     ///< assembled is faster for many columns in cache
    std::string device;  ///< empty: best; else "platform.device" numbers or part of a device name
};

/// Who computes: written into every result.
struct BackendInfo {
    std::string backend;   ///< "reference", "opencl"
    std::string platform;  ///< empty for host back ends
    std::string device;
    std::string version;  ///< driver or library version
    Precision precision = Precision::double_;
    Product product = Product::assembled;
    int compute_units = 0;
    std::string type = "host";  ///< "CPU", "GPU" or "accelerator" where a driver says so
};

/// The operations that conjugate gradients, the adjoint and condensation are written on. One object
/// holds one model. Vectors have 3 num_nodes rows (mm or mN) and `columns` >= 1.
/// All functions throw Error(device_failed) when the device reports an error, and
/// Error(invalid_argument) on a size mismatch. Results are deterministic: sums have a fixed order.
class Backend {
public:
    virtual ~Backend() = default;

    virtual BackendInfo describe() const = 0;

    /// Brings mesh, materials and prescribed flags to the device and computes element stiffness.
    /// Calls `check_model` first: no node number outside the mesh ever reaches a device.
    virtual void prepare(const Model& model) = 0;
    /// New Young's moduli [num materials], kPa, for the prepared model; geometry is kept.
    virtual void set_stiffness(std::span<const double> stiffness_kpa) = 0;

    virtual std::unique_ptr<DeviceVector> make_vector(Index rows, Index columns) = 0;
    /// Host arrays are [rows, columns] row-major (column index fastest), fp64.
    virtual void copy_in(std::span<const double> host, DeviceVector& v) = 0;
    virtual void copy_out(const DeviceVector& v, std::span<double> host) = 0;

    virtual void fill(DeviceVector& v, double value) = 0;
    /// y = alpha_c x + beta_c y for every column c; alpha and beta have `columns` entries.
    /// With beta_c == 0 the old content of y is not read.
    virtual void axpby(std::span<const double> alpha, const DeviceVector& x,
                       std::span<const double> beta, DeviceVector& y) = 0;
    /// result_c = sum over rows of x_c y_c, accumulated in fp64 where the device has it.
    virtual void dot(const DeviceVector& x, const DeviceVector& y, std::span<double> result) = 0;

    /// y = K x without regard to prescribed dofs: nodal forces (mN) of the displacement x (mm).
    virtual void internal_force(const DeviceVector& x, DeviceVector& y) = 0;
    /// y = K x on free dofs; at prescribed dofs K is the identity (rows and columns).
    virtual void apply_stiffness(const DeviceVector& x, DeviceVector& y) = 0;
    /// z = D^-1 r with D the 3x3 diagonal blocks of the constrained K (block-Jacobi).
    virtual void apply_block_jacobi(const DeviceVector& r, DeviceVector& z) = 0;
    /// energy_c = 1/2 x_c . K x_c (mN mm), unconstrained.
    virtual void strain_energy(const DeviceVector& x, std::span<double> energy) = 0;
    /// gradient[material] = sum over columns of lambda_c . K_r x_c with K_r the unit-modulus
    /// stiffness of region r (unconstrained): dK/dE_r = K_r.
    virtual void parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                                    std::span<double> gradient) = 0;

    /// Returns when everything asked for has been done.
    virtual void wait() = 0;
};

}  // namespace palpate
