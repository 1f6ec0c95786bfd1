import palpate


def tell(stage, fraction, message):
    if message:
        print(stage, message)


phantom = palpate.phantom(seed=3, stiffness_kpa=80.0)  # two label volumes and settings
result = palpate.recover(phantom.reference, phantom.target, phantom.settings, progress=tell)
prostate = result.regions["prostate"]
low, high = prostate["interval_kpa"]
print(f"{prostate['stiffness_kpa']:.0f} kPa ({low:.0f} to {high:.0f}) for {phantom.stiffness_kpa}")
print(prostate["verdict"], "-", prostate["reason"])
result.write("phantom_result")  # report.html and the rest
