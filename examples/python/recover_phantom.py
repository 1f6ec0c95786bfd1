import palpate

phantom = palpate.phantom(seed=3, stiffness_kpa=80.0)  # two label volumes and settings
print(phantom.reference.voxels.shape, phantom.reference.spacing)

result = palpate.recover(
    phantom.reference, phantom.target, phantom.settings,
    progress=lambda stage, fraction, message: print(f"{stage} {message}"))

prostate = result.regions["prostate"]
low, high = prostate["interval_kpa"]
print(f"{prostate['stiffness_kpa']:.0f} kPa ({low:.0f} to {high:.0f}) for {phantom.stiffness_kpa}")
print(prostate["verdict"], "-", prostate["reason"])
print("largest displacement", abs(result.displacement).max(), "mm")
result.write("phantom_result")  # report.html and the rest
